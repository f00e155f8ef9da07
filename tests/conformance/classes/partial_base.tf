// expect: ok
model M
  partial model Base
    Real x;
  end Base;
  extends Base;
equation
  x = time;
end M;
