// expect: ok
// model: M
function norm2
  input Real v[:];
  output Real y;
protected
  Real squares[size(v, 1)];
  Integer i;
algorithm
  for k in 1:size(v, 1) loop
    squares[k] := v[k]^2;
  end for;
  y := 0;
  i := 1;
  while i <= size(v, 1) loop
    y := y + squares[i];
    i := i + 1;
  end while;
  y := sqrt(y);
end norm2;
model M
  Real n = norm2({3, 4, time});
end M;
