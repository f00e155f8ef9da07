// expect: TF0453 at 4:25
model M
  Real x = time;
  annotation(experiment(Stoptime = 2, StopTime = 1, __Other_Algorithm = "dassl"));
end M;
