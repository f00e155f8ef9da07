// expect: TF0304 at 5:16
model ElementWithValue "what an element has been given in the wrong place is not missed again"
  coordinate Real y;
  body b(mass = 1, position = y);
  force push = 3;
end ElementWithValue;
