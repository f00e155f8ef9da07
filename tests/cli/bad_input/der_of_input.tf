model DerOfInput
  input Real u;
  Real x = der(u);
end DerOfInput;
