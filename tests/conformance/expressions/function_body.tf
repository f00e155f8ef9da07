// expect: TF0444 at 8:9
// model: M
function root
  input Real x;
  output Real y;
algorithm
  y := x;
  while abs(y*y - x) > 1e-9 loop
    y := (y + x/y)/2;
  end while;
end root;
model M
  Real x = root(2 + time);
end M;
