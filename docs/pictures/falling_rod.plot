title "examples/falling_rod.tf: friction reverses inside the first impact"
size 960 330
columns 2
panel "The rod every 0.04 s"
equal
x "x in m"
y "y in m"
outline falling_rod.csv 0.04 "tip[1,1]" "tip[1,2]" "tip[2,1]" "tip[2,2]"
horizontal 0
panel "Velocities of its left end"
x "t in s"
y "m/s"
line falling_rod.csv time "floor[1].slip" "slip"
line falling_rod.csv time "der(r[2])" "centre, vertical"
