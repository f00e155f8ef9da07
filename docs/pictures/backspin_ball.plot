title "examples/backspin_ball.tf: friction bends the path of the ball and turns it back, then it rolls"
size 960 330
columns 2
panel "Path on the floor"
equal
x "x in m"
y "y in m"
line backspin_ball.csv "p[1]" "p[2]"
panel "Velocity and slip"
x "t in s"
y "m/s"
range x 0 1.5
line backspin_ball.csv time "der(p[1])" "der(p[1])"
line backspin_ball.csv time "der(p[2])" "der(p[2])"
line backspin_ball.csv time "floor.slip[1]" "slip[1]"
line backspin_ball.csv time "floor.slip[2]" "slip[2]"
