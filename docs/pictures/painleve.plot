title "examples/painleve_rod.tf: a frictional impulse throws the sliding rod off the floor"
size 960 330
columns 2
panel "The rod every 0.02 s"
equal
x "x in m"
y "y in m"
outline painleve_rod.csv 0.02 "tip[1,1]" "tip[1,2]" "tip[2,1]" "tip[2,2]"
horizontal 0
panel "Gap of the sliding end"
x "t in s"
y "m"
line painleve_rod.csv time "floor[1].gap"
