within TF;
package Constants = Modelica.Constants "mathematical constants and constants of nature";
