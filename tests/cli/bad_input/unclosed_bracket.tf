model UnclosedBracket
  Real x = 2*(time + 1;
  Real y = 3;
end UnclosedBracket;
