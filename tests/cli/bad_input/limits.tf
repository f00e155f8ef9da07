model Limits "values that are not allowed"
  type Gear = enumeration(neutral, first, second);
  parameter Gear gear = Gear.first;
  input Real u(min = 0, max = 1);
  coordinate Real x;
  body load(mass = 1, position = x);
  force drive(value = if gear == Gear.neutral then 0 else u, at = x);
end Limits;
