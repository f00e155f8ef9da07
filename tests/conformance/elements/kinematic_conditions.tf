// expect: ok
model M "conditions that no coordinate takes part in"
  parameter Integer n = 3;
  parameter Boolean tilted = false;
  parameter Real c = 1;
  coordinate Real x[n](start = {2*i for i in 1:n});
  coordinate Real y(start = 1);
  body ball[n](each mass = 1, position = x);
  body slider(mass = 1, position = y);
  contact row[n](gap = {if i == 1 then x[i] + 1 else x[i] - x[i - 1] - 1 for i in 1:n});
  contact wall(gap = if tilted then y - 0.1*x[1] else y);
  contact floor(gap = if c > 0 then y + c else 2*y);
  contact ground(gap = if time < 1 then y + 1 else y + 2 - time);
end M;
