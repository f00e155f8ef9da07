title "Collisions of several bodies"
size 960 330
columns 2
panel "examples/newtons_cradle.tf: angles of the five balls"
x "t in s"
y "rad"
line newtons_cradle.csv time "phi[1]" "first"
line newtons_cradle.csv time "phi[3]" "middle"
line newtons_cradle.csv time "phi[5]" "last"
panel "examples/column.tf: heights of four balls"
x "t in s"
y "m"
range x 0 0.5
line column.csv time "y[1]"
line column.csv time "y[2]"
line column.csv time "y[3]"
line column.csv time "y[4]"
