// expect: TF0201 at 4:64
model M "what is not reached is checked all the same"
  parameter Real x[3] = {1, 2, 3};
  Real y[3] = {if i == 1 then x[1] elseif i < 9 then x[i] else z for i in 1:3};
end M;
