// expect: TF0227 at 7:16
model M
  model Base
    Real x = 1;
    Real y = 2;
  end Base;
  extends Base(break y);
end M;
