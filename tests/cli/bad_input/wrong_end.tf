model WrongEnd
  Real x = time;
end WrongEmd;
