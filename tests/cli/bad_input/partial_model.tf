partial model PartialModel
  Real x = time;
end PartialModel;
