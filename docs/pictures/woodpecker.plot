title "examples/woodpecker.tf: slip, jam and impact in turn"
size 960 330
columns 3
panel "Height of the sleeve"
x "t in s"
y "m"
line woodpecker.csv time y
panel "Angle of the sleeve"
x "t in s"
y "rad"
line woodpecker.csv time phiM
panel "Limit cycle of the woodpecker"
x "angle in rad"
y "angular velocity in rad/s"
line woodpecker.csv phiS "der(phiS)"
