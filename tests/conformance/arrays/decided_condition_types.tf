// expect: TF0404 at 3:17
model M "values that are not reached have the type of the others all the same"
  Real y[2] = {(if i == 1 then 0 else "one") for i in 1:2};
end M;
