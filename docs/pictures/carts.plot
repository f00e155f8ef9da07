title "Plastic collisions: a driven cart between two others; two carts and a buffer"
size 960 330
columns 2
panel "examples/three_carts.tf"
x "t in s"
y "position in m"
line three_carts.csv time "x[1]" "left"
line three_carts.csv time "x[2]" "middle"
line three_carts.csv time "x[3]" "right"
panel "examples/carts.tf"
x "t in s"
y "velocity in m/s"
line carts.csv time "der(x[1])" "first"
line carts.csv time "der(x[2])" "second"
