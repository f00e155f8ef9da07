title "Infinitely many impacts in finite time, and rest"
size 960 330
columns 3
panel "examples/bouncing_ball.tf"
x "t in s"
y "height in m"
line bouncing_ball.csv time y
vertical 4.0637 rest
panel "examples/superball.tf: backspin"
x "x in m"
y "y in m"
line superball.csv "r[1]" "r[2]"
horizontal 0
panel "examples/rocking_block.tf"
x "t in s"
y "angle in rad"
line rocking_block.csv time phi
vertical 3.9401 rest
