title "examples/moving_ground.tf: lift-off from a swinging table and landing on it"
size 960 330
columns 2
panel "Heights"
x "t in s"
y "m"
line moving_ground.csv time y "particle"
line moving_ground.csv time table "table"
panel "Contact force"
x "t in s"
y "N"
line moving_ground.csv time "surface.normalForce"
