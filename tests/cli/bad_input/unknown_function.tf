model UnknownFunction
  Real x = sinus(time);
end UnknownFunction;
