// expect: ok
package Water
  constant Real density = 1000;
end Water;
package Oil
  constant Real density = 900;
end Oil;
model M
  model Tank
    replaceable package Medium = Water;
    Real mass = Medium.density*time;
  end Tank;
  Tank water;
  Tank oil(redeclare package Medium = Oil);
end M;
