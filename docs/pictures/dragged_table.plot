# tfc run examples/dragged_table.tf
title "examples/dragged_table.tf: four feet stick together, then each slips in its own direction"
size 960 330
columns 2
panel "Motion of the centre"
x "t in s"
y "m, rad"
line dragged_table.csv time "q[1]" "q[1]"
line dragged_table.csv time "q[2]" "q[2]"
line dragged_table.csv time "psi" "psi"
panel "Normal forces of the feet: the least that hold the table"
x "t in s"
y "N"
line dragged_table.csv time "foot[1].normalForce" "foot[1]"
line dragged_table.csv time "foot[2].normalForce" "foot[2]"
line dragged_table.csv time "foot[3].normalForce" "foot[3]"
line dragged_table.csv time "foot[4].normalForce" "foot[4]"
