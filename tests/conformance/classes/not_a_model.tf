// expect: TF0233 at 3:8
// model: R
record R
  Real x;
end R;
