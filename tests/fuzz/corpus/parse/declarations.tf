model Declarations
  parameter Real a(unit = "kg", min = 0) = 1 "mass", b[2, :] = [1, 2; 3, 4];
  constant Integer n := 3;
  discrete input Boolean on(start = true);
  flow Real f;
  stream output Real h;
  final parameter .Modelica.Units.SI.Mass[3] m = {1, 2, 3} annotation(Dialog(group = "g"));
  inner Real g if n > 2 "conditional";
  outer World world;
  replaceable Resistor r(R = 2) "desc" constrainedby OnePort(final v(start = 1)) "other" annotation(choicesAllMatching = true);
  redeclare replaceable Foo foo;
  Real 'quoted name' = 1.5e-3, 'it\'s' = .5, y = 1., z = 1E+6;
  String s = "with \"escapes\"\n and
line breaks";
  A x(redeclare model M = N(k = 1), redeclare each final replaceable Real p[2] = 3 constrainedby Real, each final q(r = 1) = 2,
      redeclare replaceable package Medium = Air "air" constrainedby Base, final replaceable type T = Real, b = break, der(start = 1) "velocity");
  coordinate Real c(start = 1, der(start = 2, fixed = false)), d[2];
  coordinate Modelica.Units.SI.Angle[2] phi;
  coordinate .Real e;
  coordinate coordinate;
  coordinate coordinate2, other[2];
  coordinate coordinate coordinate3;
  body block(mass = 2, position = {c, 0});
  Real optimization, constraint, contact, friction;
end Declarations;
