// expect: ok
model M
  model World
    parameter Real g = 9.81;
  end World;
  model Part
    outer World world;
    Real weight = 2*world.g;
  end Part;
  model Group
    Part part;
  end Group;
  inner World world(g = 1.62);
  Group group;
end M;
