// expect: TF0239 at 5:10
model M
  model Ball
    extends body(mass = 1);
    Real height = 2;
  end Ball;
  coordinate Real y;
  Ball ball(position = y);
end M;
