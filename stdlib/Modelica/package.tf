package Modelica "the part of the Modelica Standard Library that models of mechanics need"
end Modelica;
