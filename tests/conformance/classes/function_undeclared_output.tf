// expect: TF0201 at 7:5
model UndeclaredOutput "a function assigns to what it has not declared"
  function double
    input Real x;
    output Real doubled;
  algorithm
    dubled := 2*x;
    doubled := x + x;
  end double;
  coordinate Real y(start = double(1));
  body b(mass = 1, position = y);
end UndeclaredOutput;
