model CoordinateWithPrefix
  input coordinate Real x;
end CoordinateWithPrefix;
