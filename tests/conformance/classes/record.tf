// expect: ok
model M
  record Load
    Real mass(unit = "kg");
    Real arm[2] = {1, 0};
  end Load;
  parameter Load load(mass = 3);
  parameter Load other = Load(mass = 2, arm = {0, 1});
  Real moment[2] = load.mass*load.arm + other.mass*other.arm;
end M;
