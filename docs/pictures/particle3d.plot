# tfc run examples/particle3d.tf
title "examples/particle3d.tf: friction opposes the direction of the slip, which turns towards that of the wind"
size 960 330
columns 2
panel "Velocity"
x "t in s"
y "m/s"
line particle3d.csv time "der(q[1])" "der(q[1])"
line particle3d.csv time "der(q[2])" "der(q[2])"
panel "Friction force"
x "t in s"
y "N"
line particle3d.csv time "floor.frictionForce[1]" "frictionForce[1]"
line particle3d.csv time "floor.frictionForce[2]" "frictionForce[2]"
