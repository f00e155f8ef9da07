model A
  function f
    input Real x;
  algorithm
    y = x;
    if x == 1 then
      y := 2;
    elsif x == 2 then
      y := 3;
    else if x == 3 then
      y := 4;
    end if;
  end f;
  Real x;
end A;
