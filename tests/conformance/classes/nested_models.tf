// expect: ok
model M
  model Leg
    parameter Real length = 1;
    coordinate Real phi(start = 0.1);
    body foot(mass = 1, position = {length*sin(phi), -length*cos(phi)});
  end Leg;
  model Robot
    Leg left, right(length = 2);
    gravity g(acceleration = {0, -9.81});
  end Robot;
  Robot robot(left(phi(start = 0.5)));
end M;
