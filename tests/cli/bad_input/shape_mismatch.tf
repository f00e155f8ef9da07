model ShapeMismatch
  Real x[3] = {1, 2}*time;
end ShapeMismatch;
