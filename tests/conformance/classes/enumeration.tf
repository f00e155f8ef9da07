// expect: ok
model M
  type Gear = enumeration(low "slow", high);
  parameter Gear gear = Gear.high;
  Real r = if gear == Gear.low then 3 else 1;
end M;
