optimization O(finalTime = 1)
  extends A;
constraint
  x(finalTime);
  x <= 3;
  x == 2;
  when x > 1 then y = 2; end when;
  Real y;
end O;
