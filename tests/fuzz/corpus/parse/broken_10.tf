model A
  Real x; /* foo
end A;
