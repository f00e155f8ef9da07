title "examples/pushed_block.tf: stick, slip and stick under a swinging force"
size 960 330
columns 2
panel "Velocity"
x "t in s"
y "m/s"
line pushed_block.csv time "der(q[1])" "der(q[1])"
panel "Friction force"
x "t in s"
y "N"
line pushed_block.csv time "floor.frictionForce" "friction"
horizontal 3.924 "mu m g"
horizontal -3.924
