title "examples/falling_box.tf: tumbles over a corner, slides to rest on a face"
size 960 330
columns 2
panel "The box every 0.1 s"
equal
x "x in m"
y "y in m"
outline falling_box.csv 0.1 "corner[1,1]" "corner[1,2]" "corner[2,1]" "corner[2,2]" "corner[3,1]" "corner[3,2]" "corner[4,1]" "corner[4,2]" "corner[1,1]" "corner[1,2]"
horizontal 0
panel "Normal forces of the corners"
x "t in s"
y "N"
line falling_box.csv time "floor[1].normalForce" "corner 1"
line falling_box.csv time "floor[2].normalForce" "corner 2"
line falling_box.csv time "floor[3].normalForce" "corner 3"
line falling_box.csv time "floor[4].normalForce" "corner 4"
