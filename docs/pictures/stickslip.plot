title "examples/stickslip.tf: caught by the belt, released by the spring"
size 960 330
columns 2
panel "Velocity"
x "t in s"
y "m/s"
line stickslip.csv time "der(x)" "mass"
horizontal 0.3 "belt"
panel "Limit cycle"
x "position in m"
y "velocity in m/s"
line stickslip.csv x "der(x)"
