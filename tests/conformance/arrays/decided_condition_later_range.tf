// expect: TF0423 at 4:56
model M "the value that a decided condition leaves is needed, as if there were no condition"
  Real x[3] = {time, 1, 2};
  Real y[3] = {if i == 0 then x[1] elseif i < 3 then x[i + 2] else x[i] for i in 1:3};
end M;
