model First
  Real x = time;
end First;

model Second
  Real x = 2*time;
end Second;
