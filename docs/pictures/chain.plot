title "examples/chain.tf: three rods fall flat"
size 960 330
columns 2
panel "The chain every 0.02 s"
equal
x "x in m"
y "y in m"
outline chain.csv 0.02 "r[1]" "r[2]" "node[2,1]" "node[2,2]" "node[3,1]" "node[3,2]" "node[4,1]" "node[4,2]"
horizontal 0
panel "Angles"
x "t in s"
y "rad"
line chain.csv time "phi[1]" "phi[1]"
line chain.csv time "phi[2]" "phi[2]"
line chain.csv time "phi[3]" "phi[3]"
