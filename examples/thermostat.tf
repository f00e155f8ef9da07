// A heater with an ideal thermostat: on below the set point, off above it. The room warms up, then slides along the set point; the energy used
// grows with the mean power, which follows the outside temperature, until the heater at full power no longer suffices and the temperature drops.
//
//   tfc run thermostat.tf
model Thermostat "ideal thermostat: sliding along the set point"
  parameter Real setpoint = 20 "set point in degrees Celsius";
  parameter Real loss = 0.2 "heat loss of the room per hour";
  parameter Real power = 6 "heating rate of the heater in K/h";
  Real T(start = 12, fixed = true) "room temperature";
  Real used(start = 0, fixed = true) "heat used, as warming of the room";
  Real outside = 6 - time "outside temperature, time in hours";
  Real heating = if T < setpoint then power else 0;
equation
  der(T) = -loss*(T - outside) + heating;
  der(used) = heating;
  annotation(experiment(StopTime = 24, Tolerance = 1e-9));
end Thermostat;
