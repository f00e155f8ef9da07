// expect: TF0203 at 3:41
model M
  parameter Real r = Modelica.Constants.pie;
end M;
