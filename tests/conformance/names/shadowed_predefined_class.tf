// expect: ok
model M
  model body
    parameter Real mass = 1;
    coordinate Real x;
    .body b(mass = mass, position = x);
  end body;
  body b(mass = 2);
end M;
