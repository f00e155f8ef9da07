model A
  Real x;
