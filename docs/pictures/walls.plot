title "Walls: ever slower to and fro; held until the wind turns; two rods that hit and slide"
size 960 330
columns 3
panel "examples/two_walls.tf"
x "t in s"
y "position in m"
line two_walls.csv time x
horizontal 0
horizontal 1
panel "examples/pendulum_wall.tf"
x "t in s"
y "angle in rad"
line pendulum_wall.csv time phi
horizontal -0.30469 "wall"
panel "examples/double_pendulum.tf"
equal
x "x in m"
y "y in m"
outline double_pendulum.csv 0.05 0 0 "joint[1]" "joint[2]" "tip[1]" "tip[2]"
vertical 0.4 "wall"
