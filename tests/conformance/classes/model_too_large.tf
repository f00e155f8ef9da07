// expect: TF0236 at 6:5
model M
  model A
    Real x = time;
  end A;
  A a[600, 500];
end M;
