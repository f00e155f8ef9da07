model A
  Real x = foo(1, 2;
  Real y = [1, 2; 3 4; 5, 6];
  Real z = {1, 2;
equation
  x = (1 + 2;
  if x = 1 then
    y = 2;
  end for;
end A;
