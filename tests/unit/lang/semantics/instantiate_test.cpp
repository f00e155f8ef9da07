// Flat models of small sources, compared with their printed form.
#include "tests/unit/lang/semantics/instantiate_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

using ::testing::HasSubstr;

std::string flatten(const std::string &text, const std::string &model = "", const std::map<std::string, double> &overrides = {}) {
  const Workspace workspace;
  Outcome outcome;
  instantiateText(outcome, workspace, text, model, overrides);
  EXPECT_EQ(outcome.rendered(workspace), "");
  return outcome.flat();
}

TEST(Instantiate, particle) {
  const std::string flat = flatten(readFile(std::string(TF_SOURCE_DIR) + "/tests/accuracy/contract/particle.tf"));
  EXPECT_EQ(flat, R"tf(model Particle "point mass above a rough floor (lecture: warm-up example, slip/stick, lift-off)"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0 "coefficient of restitution";
  input Real u[2](unit = "N") "applied force";
  coordinate Real q[2](start = {0, 1}, der(start = {0, 0})) "position";
  body ball(mass = m, position = q);
  force weight(value = {0, -m*g}, at = q);
  force thrust(value = u, at = q);
  contact floor(gap = q[2], slip = der(q[1]), friction = mu, restitution = e, law = ImpactLaw.Poisson, rate = 9.81);
  annotation(experiment(StopTime = 4, Tolerance = 1e-09));
end Particle;
)tf");
}

TEST(Instantiate, modificationsOfOuterClassesWin) {
  const std::string flat = flatten(R"(
model M
  model A
    parameter Real k = 1;
    parameter Real l = 1;
    Real x(start = 1, min = -5);
  equation
    der(x) = -k*x + l;
  end A;
  model B
    extends A(k = 2, x(start = 3));
  end B;
  B b(k = 4, x(max = 9));
  annotation(experiment(StopTime = 1));
end M;
)");
  EXPECT_THAT(flat, HasSubstr("parameter Real b.k = 4;\n  parameter Real b.l = 1;\n  Real b.x(start = 3, min = -5, max = 9);"));
  EXPECT_THAT(flat, HasSubstr("der(b.x) = -b.k*b.x + b.l;"));
}

TEST(Instantiate, arraysOfModelsSplitModifications) {
  const std::string flat = flatten(R"(
model M
  model A
    parameter Real k = 1;
    Real x(start = 0);
  equation
    der(x) = -k*x;
  end A;
  A a[2, 2](k = [1, 2; 3, 4], each x(start = 7));
  Real total = sum(a.x) + a[2, 1].x;
end M;
)");
  EXPECT_THAT(flat, HasSubstr("parameter Real a[1,2].k = 2;\n  Real a[1,2].x(start = 7);"));
  EXPECT_THAT(flat, HasSubstr("parameter Real a[2,1].k = 3;"));
  EXPECT_THAT(flat, HasSubstr("Real total = sum({{a[1,1].x, a[1,2].x}, {a[2,1].x, a[2,2].x}}) + a[2,1].x;"));
}

TEST(Instantiate, eachOfOneOfSeveralModificationsHoldsForThatOne) {
  const std::string flat = flatten(R"(
model M
  model A
    Real y(start = 1);
  equation
    der(y) = -y;
  end A;
  model B
    A a[2](each y(nominal = 2));
  end B;
  A before[2](each y(min = -9), y(start = {1, 2}));
  A behind[2](y(start = {3, 4}), each y(min = -8), y.max = {7, 8});
  B b(a(y(start = {5, 6})));
end M;
)");
  for (const char *line :
       {"before[2].y(start = 2, min = -9)", "behind[1].y(start = 3, min = -8, max = 7)", "behind[2].y(start = 4, min = -8, max = 8)",
        "b.a[1].y(start = 5, nominal = 2)", "b.a[2].y(start = 6, nominal = 2)"})
    EXPECT_THAT(flat, HasSubstr(line));
}

TEST(Instantiate, redeclarationsWithoutDimensionsKeepThem) {
  const std::string flat = flatten(R"(
model M
  model A
    parameter Real k = 1;
  end A;
  model B
    extends A;
    parameter Real l = 2;
  end B;
  model Holder
    parameter Integer n = 2;
    replaceable A a[n](k = {1, 2});
  end Holder;
  parameter Integer n = 5;
  Holder kept(redeclare B a(l = {3, 4})), changed(redeclare B a[3](k = {5, 6, 7}));
end M;
)");
  EXPECT_THAT(flat, HasSubstr("kept.a[2].k = 2;"));
  EXPECT_THAT(flat, HasSubstr("kept.a[2].l = 4;"));
  EXPECT_THAT(flat, testing::Not(HasSubstr("kept.a[3]")));
  EXPECT_THAT(flat, HasSubstr("changed.a[3].k = 7;"));
}

TEST(Instantiate, structuralParametersAreFolded) {
  const std::string text = R"(
model M
  parameter Integer n = 2;
  parameter Real a[n] = {i for i in 1:n};
  Real x[n](each start = 1);
equation
  for i in 1:n loop
    der(x[i]) = -n*a[i]*x[i];
  end for;
end M;
)";
  const std::string flat = flatten(text);
  EXPECT_THAT(flat, HasSubstr("structural parameter Integer n = 2;\n  parameter Real a[2] = {1, 2};"));
  EXPECT_THAT(flat, HasSubstr("der(x[2]) = -2*a[2]*x[2];"));
  EXPECT_THAT(flatten(text, "", {{"n", 3}}), HasSubstr("der(x[3]) = -3*a[3]*x[3];"));
}

// Their values are compiled in, so that no other value of the parameter may come with the run; starts follow their parameters.
TEST(Instantiate, parametersOfBoundsAndNominalsAreStructural) {
  const std::string flat = flatten(R"(
model M
  parameter Real size = 2, low = -size, fast = 5, top = 9, x0 = 1;
  parameter Boolean held = true;
  parameter Real k(max = top) = 3;
  coordinate Real x(start = x0, min = low, nominal = 10*size, der(nominal = fast, fixed = held));
  body b(mass = k, position = x);
end M;
)");
  for (const char *name : {"Real size = 2", "Real low = -2", "Real fast = 5", "Real top = 9", "Boolean held = true"})
    EXPECT_THAT(flat, HasSubstr(std::string("structural parameter ") + name + ";"));
  EXPECT_THAT(flat, testing::Not(HasSubstr("structural parameter Real x0")));
  EXPECT_THAT(flat, HasSubstr("start = x0"));
  EXPECT_THAT(flat, HasSubstr("nominal = 10*2"));
}

TEST(Instantiate, redeclarationsAndInnerOuter) {
  const std::string flat = flatten(R"(
model M
  model World
    parameter Real g = 10;
  end World;
  partial model Law
    Real f;
  end Law;
  model Linear
    extends Law;
  equation
    f = -1;
  end Linear;
  model Heavy
    extends Law;
    outer World world;
  equation
    f = -world.g;
  end Heavy;
  model Holder
    replaceable model Used = Linear constrainedby Law;
    Used used;
  end Holder;
  inner World world(g = 3);
  Holder first;
  Holder second(redeclare model Used = Heavy);
end M;
)");
  EXPECT_THAT(flat, HasSubstr("first.used.f = -1;"));
  EXPECT_THAT(flat, HasSubstr("second.used.f = -world.g;"));
}

TEST(Instantiate, importsOfAllKinds) {
  const std::string flat = flatten(R"(
package P
  package Q
    constant Real a = 1;
    constant Real b = 2*a;
    constant Real c = 3;
  end Q;
end P;
model M
  import P.Q.a;
  import renamed = P.Q.b;
  import P.Q.{c};
  import Modelica.Math.*;
  encapsulated package E
    import P.Q;
    constant Real d = 4*Q.c;
  end E;
  Real x = a + renamed + c + E.d + sin(time) + Modelica.Math.cos(time);
end M;
)",
                                   "M");
  EXPECT_THAT(flat, HasSubstr("Real x = 1 + 2 + 3 + 12 + sin(time) + cos(time);"));
}

TEST(Instantiate, libraryFilesBesideTheModel) {
  const Workspace workspace;
  workspace.write("Shapes/package.mo", "package Shapes\nconstant Real unit = 2;\nend Shapes;\n");
  workspace.write("Shapes/Ball.mo", "within Shapes;\nmodel Ball\nparameter Real r = unit;\nend Ball;\n");
  workspace.write("spring.tf", "model Spring\nparameter Real k = 5;\nend Spring;\n");
  const std::string file = workspace.write("M.tf", "model M\nShapes.Ball ball;\nSpring spring;\nend M;\n");
  Outcome outcome;
  instantiateFiles(outcome, {file});
  EXPECT_EQ(outcome.rendered(workspace), "");
  EXPECT_EQ(outcome.flat(), "model M\n  parameter Real ball.r = 2;\n  parameter Real spring.k = 5;\nend M;\n");
  EXPECT_EQ(outcome.instantiation.files.size(), 4U);
}

TEST(Instantiate, aFileOfAPackageThatIsNotThere) {
  EXPECT_EQ(flatten("within Lost.Package;\nmodel M\n  Real x = time;\nend M;\n"), "model M\n  Real x = time;\nend M;\n");
}

TEST(Instantiate, functionsAreExpanded) {
  const std::string flat = flatten(R"(
function horner
  input Real c[:];
  input Real x;
  output Real y;
algorithm
  y := 0;
  for i in size(c, 1):-1:1 loop
    y := y*x + c[i];
  end for;
end horner;
function limit
  input Real u;
  input Real bound = 1;
  output Real y;
  output Boolean hit;
algorithm
  y := u;
  hit := false;
  if u > bound then
    y := bound;
    hit := true;
  end if;
end limit;
model M
  Real p = horner({1, 2, 3}, time);
  Real y;
  Boolean hit;
  Real v[2] = limit({time, 2*time}, bound = 3);
equation
  (y, hit) = limit(p);
end M;
)",
                                   "M");
  EXPECT_THAT(flat, HasSubstr("Real p = ((0*time + 3)*time + 2)*time + 1;"));
  EXPECT_THAT(flat, HasSubstr("Real v[2] = {if time > 3 then 3 else time, if 2*time > 3 then 3 else 2*time};"));
  EXPECT_THAT(flat, HasSubstr("y = if p > 1 then 1 else p;"));
  EXPECT_THAT(flat, HasSubstr("hit = if p > 1 then true else false;"));
}

TEST(Instantiate, recordsAreTakenApart) {
  const std::string flat = flatten(R"(
model M
  record Pair
    Real a;
    Real b[2];
  end Pair;
  record Nested
    Pair p;
    Real c;
  end Nested;
  Pair first(a = time, b = {1, 2});
  Pair second = Pair(b = {3, time}, a = 4);
  Pair third = if time > 1 then first else second;
  Nested n = Nested(c = 5, p = second);
  Pair fourth;
equation
  fourth = n.p;
end M;
)");
  EXPECT_THAT(flat, HasSubstr("Real second.a = 4;\n  Real second.b[2] = {3, time};"));
  EXPECT_THAT(flat, HasSubstr("Real third.b[2] = if time > 1 then first.b else second.b;"));
  EXPECT_THAT(flat, HasSubstr("Real n.p.a = second.a;"));
  EXPECT_THAT(flat, HasSubstr("fourth.a = n.p.a;\n  fourth.b = n.p.b;"));
}

TEST(Instantiate, attributesOfElementsCanBeRead) {
  const std::string flat = flatten(R"(
model M
  parameter Real c = 2;
  coordinate Real x(start = 1), y(start = 1);
  body ball(mass = 1, position = {x, y});
  force damper(at = 2*x, value = -c*der(damper.at));
  contact wall[2](gap = {x, y}, slip = {der(y), der(x)}, each friction = 0.2);
  output Real n[2] = wall.normalForce;
  output Real f = wall[2].frictionForce + ball.kineticEnergy;
end M;
)");
  EXPECT_THAT(flat, HasSubstr("force damper(value = -c*der(2*x), at = 2*x);"));
  EXPECT_THAT(flat, HasSubstr("friction = {0.2, 0.2}"));
  EXPECT_THAT(flat, HasSubstr("output Real n[2] = wall.normalForce;"));
  EXPECT_THAT(flat, HasSubstr("output Real f = wall[2].frictionForce + ball.kineticEnergy;"));
}

TEST(Instantiate, shortClassesOfPredefinedOnes) {
  const std::string flat = flatten(R"(
model M
  model Bob = body(mass = 2);
  model Rough = contact(friction = 0.3);
  type Angle = Real(unit = "rad", nominal = 3);
  type Triple = Real[3](each unit = "m", start = {1, 2, 3});
  coordinate Angle phi(start = 1);
  Triple t[2];
  Bob bob(position = {cos(phi), sin(phi)});
  Rough wall[2](gap = {phi, 3 - phi}, each slip = der(phi));
equation
  t = fill(time*{1, 2, 3}, 2);
end M;
)");
  EXPECT_THAT(flat, HasSubstr("coordinate Real phi(start = 1, nominal = 3, unit = \"rad\");"));
  EXPECT_THAT(flat, HasSubstr("Real t[2, 3](start = {{1, 2, 3}, {1, 2, 3}}, unit = \"m\");"));
  EXPECT_THAT(flat, HasSubstr("body bob(mass = 2, position = {cos(phi), sin(phi)});"));
  EXPECT_THAT(flat, HasSubstr("friction = {0.3, 0.3}"));
}

TEST(Instantiate, ifEquations) {
  const std::string flat = flatten(R"(
model M
  parameter Boolean fast = true;
  Real x(start = 1), y(start = 1), z(start = 1);
equation
  if fast then
    der(x) = -10*x;
  else
    der(x) = -x;
    assert(false, "slow");
  end if;
  if x > 0.5 then
    der(y) = 1;
    z = 2;
  elseif x > 0.2 then
    der(y) = 2;
    0 = z - x;
  else
    der(y) = 3;
    z = 4;
  end if;
end M;
)");
  EXPECT_THAT(flat, HasSubstr("structural parameter Boolean fast = true;"));
  EXPECT_THAT(flat, HasSubstr("der(x) = -10*x;\n  der(y) = if x > 0.5 then 1 else if x > 0.2 then 2 else 3;"));
  EXPECT_THAT(flat, HasSubstr("0 = if x > 0.5 then z - 2 else if x > 0.2 then 0 - (z - x) else z - 4;"));
  EXPECT_EQ(flat.find("slow"), std::string::npos);
}

// What grows without bound is refused; long sums and large reductions are not.
TEST(Instantiate, limits) {
  const std::string functions = R"(
function power
  input Real x;
  output Real y;
algorithm
  y := x;
  for i in 1:100 loop
    y := y + y;
  end for;
end power;
function endless
  input Real x;
  output Real y;
algorithm
  y := endless(x);
end endless;
model Doubling
  Real x = power(time);
end Doubling;
model Endless
  Real x = endless(time);
end Endless;
model Reduction
  Real x = sum(sin(i*time) for i in 1:5000) + max(cos(i*time) for i in 1:5000);
end Reduction;
)";
  for (const char *model : {"Doubling", "Endless"}) {
    const Workspace workspace;
    Outcome outcome;
    instantiateText(outcome, workspace, functions, model);
    ASSERT_EQ(outcome.diagnostics.errorCount(), 1) << outcome.rendered(workspace);
    EXPECT_STREQ(outcome.diagnostics.all()[0].kind->code, "TF0237");
  }
  EXPECT_NE(flatten(functions, "Reduction"), "");
  std::string sum = "model M Real x = time";
  for (int i = 0; i < 1500; ++i)
    sum += " + time";
  EXPECT_NE(flatten(sum + "; end M;"), "");
}

TEST(Instantiate, severalModelsAreCandidates) {
  const Workspace workspace;
  Outcome outcome;
  instantiateText(outcome, workspace, "model A\nend A;\npartial model B\nend B;\nblock C\nend C;\nfunction f\nend f;\n");
  EXPECT_FALSE(outcome.instantiation.model.has_value());
  EXPECT_THAT(outcome.instantiation.candidates, ::testing::ElementsAre("A", "C"));
  EXPECT_TRUE(outcome.diagnostics.all().empty());
}

TEST(Instantiate, severalErrorsInOneRunWithoutCascades) {
  const Workspace workspace;
  Outcome outcome;
  instantiateText(outcome, workspace, R"(model M
  Reel x;
  Real y = x + undeclared;
  Real z[2] = {1, 2, 3};
equation
  for i in 1:5 loop
    z[i] = unknown;
  end for;
end M;
)");
  EXPECT_THAT(outcome.positions(), ::testing::UnorderedElementsAre("TF0202 at 2:3", "TF0201 at 3:16", "TF0409 at 4:15", "TF0201 at 7:12"));
}

}  // namespace
}  // namespace tf::test
