title "examples/tumbling_box.tf: over one corner after the other, and to rest on a face"
size 960 330
columns 2
panel "The box every 0.12 s, from the side"
equal
x "x in m"
y "z in m"
outline tumbling_box_begin.csv 0.12 "corner[1,1]" "corner[1,3]" "corner[2,1]" "corner[2,3]" "corner[3,1]" "corner[3,3]" "corner[4,1]" "corner[4,3]" "corner[1,1]" "corner[1,3]" "corner[5,1]" "corner[5,3]" "corner[6,1]" "corner[6,3]" "corner[2,1]" "corner[2,3]" "corner[6,1]" "corner[6,3]" "corner[7,1]" "corner[7,3]" "corner[3,1]" "corner[3,3]" "corner[7,1]" "corner[7,3]" "corner[8,1]" "corner[8,3]" "corner[4,1]" "corner[4,3]" "corner[8,1]" "corner[8,3]" "corner[5,1]" "corner[5,3]"
horizontal 0
panel "Velocity of its centre"
x "t in s"
y "m/s"
line tumbling_box.csv time "der(p[1])" "forward"
line tumbling_box.csv time "der(p[3])" "upward"
