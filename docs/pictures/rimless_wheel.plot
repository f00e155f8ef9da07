title "A wheel without a rim on a slope: slow or fast at the start, it comes to its own speed"
size 960 330
columns 2
panel "examples/rimless_wheel.tf"
x "t in s"
y "angular velocity in rad/s"
line slow_wheel.csv time "der(phi)" "w = 0.8"
line fast_wheel.csv time "der(phi)" "w = 3"
panel "Feet, one after the other"
x "along the slope in m"
y "off it in m"
line slow_wheel.csv "foot[1,1]" "foot[1,2]" "first"
line slow_wheel.csv "foot[2,1]" "foot[2,2]" "second"
line slow_wheel.csv "r[1]" "r[2]" "hub"
horizontal 0
