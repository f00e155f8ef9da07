model M
  optimization O(finalTime = 1)
    extends A;
  constraint
    x <= 1;
  end O;
  Real x;
end M;
