within Modelica;
package Math = TF.Math "mathematical functions";
