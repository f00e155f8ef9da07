model UnclosedString
  Real x = time "position;
end UnclosedString;
