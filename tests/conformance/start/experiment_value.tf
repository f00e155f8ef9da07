// expect: TF0446 at 6:51
// expect: TF0446 at 6:71
// expect: TF0446 at 7:36
model M
  Real x = time;
  annotation(experiment(StartTime = 1, StopTime = "late", Tolerance = 2,
                        Interval = 0));
end M;
