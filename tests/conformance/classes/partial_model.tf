// expect: TF0232 at 3:15
// model: Base
partial model Base
  Real x;
end Base;
