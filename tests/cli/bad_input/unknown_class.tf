model UnknownClass
  Reel x = time;
end UnknownClass;
