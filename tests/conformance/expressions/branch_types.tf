// expect: TF0404 at 3:15
model M
  Real x[2] = if time > 1 then {1, 2} else {1, 2, 3};
end M;
