model A
equation
  if x > 1
    y = 2;
  end if;
  for i in 1:3
    y[i] = 2;
  end for;
  for i in 1:3 loop
    y[i] = 2;
  end if;
  endif;
end A;
