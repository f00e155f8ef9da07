package P
  constant Integer n = 3;
  type Length = Real(unit = "m", min = 0);
  type Mode = enumeretion(off, on "running");
  record Point
    Real x = 1, y = 2;
  end Point;
  function norm
    input Real v[:];
    output Real r = 0;
  protected
    Real s = 0;
  algorithm
    for i in 1:size(v, 1) loop
      s := s + v[i]^2;
    end for;
    r := if s > 0 then sqrt(s) else 0;
    while r > 100 loop
      r := r/2;
      if r < 1 then
        break;
      end if;
    end while;
  end norm;
  partial model Base
    replaceable type T = Real;
    parameter T k = 1;
    outer Real g;
  end Base;
  model Derived
    extends Base(redeclare type T = Length, k = 2);
    nPoint p(x = time);
    Real a[n, 1] = {{i*j for j in 1:2} for i in 1:0};
    Real b = sum(a) + norm({p.x, t.y}) + g;
    Boolean c = b > 1 and not k < 0;
    Mode m = if c then Mod.^on else Mode.off;
    Inteeer d = size(a, 1);
  end Derived;
  model Main
    import Modelica.Constants.pi;
    inner Real g = 9.81;
    Derived d[2](k = {1, 2}, each p(y = pi));
    Real x(start = 1, fixed = true), y;
    parameter Boolean with = true;
    Real z if with;
  equation
    der(x) = -x + y;
    y = max(d[1].a[:, 1]) + d[end].b;
    when x > 0.5 then
      reinit(x, 0.1);
    end when;
    if with then
      z = 1;
    end if;
    assert(x > -1, "low");
  end Main;
end P;
