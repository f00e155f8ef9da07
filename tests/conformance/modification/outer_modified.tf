// expect: TF0240 at 7:22
model M
  model World
    parameter Real g = 9.81;
  end World;
  model Part
    outer World world(g = 1);
    Real x = world.g*time;
  end Part;
  inner World world;
  Part part;
end M;
