model DeclaredTwice
  Real x = time;
  Real x = 2*time;
end DeclaredTwice;
