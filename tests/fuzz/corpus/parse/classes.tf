within Library.Sub;
final encapsulated partial model A "a" + "b"
  import Modelica.Constants.pi;
  import SI = Modelica.Units.SI "renaming";
  import Modelica.Math.*;
  import Modelica.Math.{sin, cos};
  extends B.C(x = 1, break c, break connect(a.p, b.n)) annotation(Icon());
  extends .Root;
  model Inner end Inner;
  block Filter = Base;
  type Angle = Real(final unit = "rad");
  type Vec = Real[3] "vector" annotation(Documentation(info = "<html></html>"));
  connector RealInput = input Real "in";
  connector RealOutput = output Real[:, 2];
  type E = enumeration(one "first", two annotation(x = 1), 'three');
  type Open = enumeration(:);
  type Empty = enumeration();
  expandable connector Bus "bus" end Bus;
  replaceable package Medium = P.Media constrainedby P.Partial(n = 2) "medium";
  redeclare final inner outer replaceable model M = N;
  class extends Base2(k = 3) "more"
    Real y;
  end Base2;
  operator record Complex
    Real re, im;
    encapsulated operator 'constructor'
      function fromReal
        input Real re;
        output Complex result(re = re, im = 0);
      algorithm
      end fromReal;
    end 'constructor';
    operator function '+' = Complex.add;
  end Complex;
public
  Real p;
protected
  Real q;
  annotation(experiment(StopTime = 1));
end A;
package P end P;
