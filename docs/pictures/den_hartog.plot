title "examples/den_hartog.tf: a driven oscillator with dry friction"
size 960 330
columns 2
panel "Position and velocity"
x "t in s"
y "m, m/s"
line den_hartog.csv time x "x"
line den_hartog.csv time "der(x)" "der(x)"
panel "Friction force: ± the bound in slip, less in stick"
x "t in s"
y "N"
line den_hartog.csv time "dry.force"
