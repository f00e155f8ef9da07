within Modelica;
package Math "mathematical functions"
  function sqrt "square root"
    input Real u;
    output Real y;
  external "builtin" y = sqrt(u);
  end sqrt;

  function sin "sine"
    input Real u;
    output Real y;
  external "builtin" y = sin(u);
  end sin;

  function cos "cosine"
    input Real u;
    output Real y;
  external "builtin" y = cos(u);
  end cos;

  function tan "tangent"
    input Real u;
    output Real y;
  external "builtin" y = tan(u);
  end tan;

  function asin "inverse sine, in [-pi/2, pi/2]"
    input Real u;
    output Real y;
  external "builtin" y = asin(u);
  end asin;

  function acos "inverse cosine, in [0, pi]"
    input Real u;
    output Real y;
  external "builtin" y = acos(u);
  end acos;

  function atan "inverse tangent, in [-pi/2, pi/2]"
    input Real u;
    output Real y;
  external "builtin" y = atan(u);
  end atan;

  function sinh "hyperbolic sine"
    input Real u;
    output Real y;
  external "builtin" y = sinh(u);
  end sinh;

  function cosh "hyperbolic cosine"
    input Real u;
    output Real y;
  external "builtin" y = cosh(u);
  end cosh;

  function tanh "hyperbolic tangent"
    input Real u;
    output Real y;
  external "builtin" y = tanh(u);
  end tanh;

  function exp "exponential, base e"
    input Real u;
    output Real y;
  external "builtin" y = exp(u);
  end exp;

  function log "natural logarithm"
    input Real u;
    output Real y;
  external "builtin" y = log(u);
  end log;

  function log10 "logarithm to the base 10"
    input Real u;
    output Real y;
  external "builtin" y = log10(u);
  end log10;

  function atan2 "inverse tangent of u1/u2 in the quadrant of (u2, u1)"
    input Real u1;
    input Real u2;
    output Real y;
  external "builtin" y = atan2(u1, u2);
  end atan2;
end Math;
