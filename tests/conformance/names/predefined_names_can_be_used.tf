// expect: ok
model M "the predefined classes are no keywords"
  parameter Real friction = 0.3, force = 2, constraint = 1;
  coordinate Real contact, y(start = 1);
  body gravity(mass = force, position = {contact, y});
  .contact floor(gap = y, slip = der(contact), friction = friction);
  .friction dry(slip = der(contact), bound = constraint);
end M;
