title "Tops: steady precession and nodding; the tippe top turns over and rises"
size 960 330
columns 3
panel "examples/spinning_top.tf"
equal
x "x of the centre in m"
y "y in m"
line spinning_top.csv "centre[1]" "centre[2]" "steady"
line nodding_top.csv "centre[1]" "centre[2]" "less spin"
panel "examples/tippe_top.tf"
x "t in s"
y "cosine of the tilt"
line tippe_top.csv time "axis[3]"
panel "Height of its centre of mass"
x "t in s"
y "m"
line tippe_top.csv time "p[3]"
