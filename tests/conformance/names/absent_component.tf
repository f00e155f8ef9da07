// expect: TF0213 at 5:12
model M
  parameter Boolean withLoad = false;
  Real load = 2*time if withLoad;
  Real x = load;
end M;
