// expect: TF0428 at 5:7
model M
  Real x[3];
equation
  for i loop
    x[1] = i;
  end for;
end M;
