title "Mechanisms: a linkage falls; a slider with clearance"
size 960 330
columns 2
panel "examples/four_bar.tf"
equal
x "x in m"
y "y in m"
outline four_bar.csv 0.06 0 0 "A[1]" "A[2]" "B[1]" "B[2]" 0.7 0
panel "examples/slider_crank.tf: the slider between its walls"
x "t in s"
y "gap in m"
line slider_crank.csv time "upper[2].gap" "upper"
line slider_crank.csv time "lower[2].gap" "lower"
