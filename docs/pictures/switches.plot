title "Sliding on a switching surface, slopes and corners"
size 960 330
columns 4
panel "examples/relay.tf"
x "t in s"
y "x, z"
line relay.csv time x x
line relay.csv time z z
panel "examples/thermostat.tf"
x "t in h"
y "degrees Celsius"
line thermostat.csv time T
horizontal 20 "set point"
panel "examples/incline.tf"
x "t in s"
y "m along the slope"
line incline.csv time s "mu = 0.3"
line incline_stays.csv time s "mu = 0.7"
panel "examples/corner.tf"
x "t in s"
y "m"
line corner.csv time "r[1]" "r[1]"
line corner.csv time "r[2]" "r[2]"
