model COperators
  Boolean a = time != 1 && time > 0;
end COperators;
