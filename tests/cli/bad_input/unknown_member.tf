model UnknownMember
  Real x = Modelica.Constants.pie*time;
end UnknownMember;
