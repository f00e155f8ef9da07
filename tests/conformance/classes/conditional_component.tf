// expect: ok
model M
  parameter Boolean isHeavy = false;
  parameter Integer n = 2;
  model Weight
    coordinate Real x;
    body b(mass = 5, position = x);
  end Weight;
  Weight weight if isHeavy;
  Weight light if not isHeavy and n > 1;
end M;
