model CoordinateBinding
  coordinate Real x = time;
  body cart(mass = 1, position = x);
end CoordinateBinding;
