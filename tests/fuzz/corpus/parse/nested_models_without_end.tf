""
  connector R l A model A model A model A l A model A model A model A model A model A model A model A model A model A model A model A model A model A model A model ne outer r = 