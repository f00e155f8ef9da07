model StringValue
  Real x = "1";
end StringValue;
