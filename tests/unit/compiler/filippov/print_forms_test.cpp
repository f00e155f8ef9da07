// The printed forms: the lecture's 2D particle as its slides have it; others in what they must say.
#include "compiler/filippov/filippov_system.h"
#include "tests/unit/compiler/mechanics/derived_model.h"

#include <gmock/gmock.h>

namespace tf::filippov {
namespace {

using test::DerivedModel;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char *kParticle = R"(
model Particle
  parameter Real m = 1, g = 9.81, mu = 0.2, a = 9.81;
  input Real u[2];
  coordinate Real q[2](start = {0, 1});
  body ball(mass = m, position = q);
  gravity weight(acceleration = {0, -g});
  force thrust(value = u, at = q);
  contact floor(gap = q[2], slip = der(q[1]), friction = mu, rate = a);
end Particle;
)";

TEST(PiecewiseForm, RegionsAndModesOfTheLecture) {
  DerivedModel model(kParticle);
  TF_ASSERT_DERIVED(model);
  const std::string text = printPiecewise(timeFreezing(*model), *model);
  EXPECT_THAT(text, HasSubstr("y = (q[1], q[2], der(q[1]), der(q[2]), time)\n"));
  EXPECT_THAT(text, HasSubstr("  c[1] = q[2]       gap of floor\n"
                              "  c[2] = der(q[2])  rate of the gap of floor\n"
                              "  c[3] = der(q[1])  slip of floor\n"));
  EXPECT_THAT(text, HasSubstr("  Q = {y | c[1] < 0, c[2] < 0}\n"
                              "  R1 = R1a ∪ R1b,  R1a = {y | c[1] > 0},  R1b = {y | c[1] < 0, c[2] > 0}\n"
                              "  R2 = Q ∩ {y | c[3] > 0}\n"
                              "  R3 = Q ∩ {y | c[3] < 0}\n"));
  EXPECT_THAT(text, HasSubstr("  y' = f_1(y, u) in R1:  f_1 = f_ODE\n"
                              "  y' = f_2(y) in R2:  f_2 = f_aux,n - f_aux,t  (time is frozen)\n"
                              "  y' = f_3(y) in R3:  f_3 = f_aux,n + f_aux,t  (time is frozen)\n"));
  EXPECT_THAT(text, HasSubstr("  f_aux,n\n    der(q[2])' = a/m\n"));
}

TEST(StewartForm, SignMatrixOfTheLecture) {
  DerivedModel model(kParticle);
  TF_ASSERT_DERIVED(model);
  const std::string text = printStewart(timeFreezing(*model), *model);
  EXPECT_THAT(text, HasSubstr("  [  1  1  1 ]  R1\n  [  1  1 -1 ]  R1\n  [  1 -1  1 ]  R1\n  [  1 -1 -1 ]  R1\n"
                              "  [ -1  1  1 ]  R1\n  [ -1  1 -1 ]  R1\n  [ -1 -1  1 ]  R2\n  [ -1 -1 -1 ]  R3\n"));
  EXPECT_THAT(text, HasSubstr("g = -S c\n  g[1] = -c[1] - c[2] - c[3]\n"));
  EXPECT_THAT(text, HasSubstr("  g[8] = c[1] + c[2] + c[3]\n"));
  EXPECT_THAT(text, HasSubstr("  y' = (theta[1] + theta[2] + theta[3] + theta[4] + theta[5] + theta[6]) f_ODE\n"
                              "     + theta[7] (f_aux,n - f_aux,t)\n"
                              "     + theta[8] (f_aux,n + f_aux,t)\n"));
}

TEST(StepForm, MultipliersOfTheLecture) {
  DerivedModel model(kParticle);
  TF_ASSERT_DERIVED(model);
  const std::string text = printStep(timeFreezing(*model), *model);
  EXPECT_THAT(text, HasSubstr("  theta[1] = alpha[1] + (1 - alpha[1])*alpha[2]\n"
                              "  theta[2] = (1 - alpha[1])*(1 - alpha[2])*alpha[3]\n"
                              "  theta[3] = (1 - alpha[1])*(1 - alpha[2])*(1 - alpha[3])\n"));
  EXPECT_THAT(text, HasSubstr("  alpha[3] in gamma(c[3])\n"));
  EXPECT_THAT(text, HasSubstr("y' = theta[1]*f_ODE + theta[2]*(f_aux,n - f_aux,t) + theta[3]*(f_aux,n + f_aux,t)\n"));
}

TEST(StepForm, RestitutionIsNoted) {
  DerivedModel model("model M\n  coordinate Real y(start = 1);\n  body b(mass = 1, position = {0, y});\n"
                     "  contact floor(gap = y, restitution = 0.5);\nend M;\n");
  TF_ASSERT_DERIVED(model);
  EXPECT_THAT(printStep(timeFreezing(*model), *model),
              HasSubstr("note: floor has the restitution 0.5; this form is that of restitution 0\n"));
}

TEST(PiecewiseForm, SwitchesInsideOde) {
  DerivedModel model("model M\n  Real x(start = 1);\nequation\n  der(x) = if x > 0 then -2 else 3;\nend M;\n");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  const std::string pieces = printPiecewise(form, *model);
  EXPECT_THAT(pieces, HasSubstr("  R1 = {y | c[1] > 0}\n  R2 = {y | c[1] < 0}\n"));
  EXPECT_THAT(pieces, HasSubstr("  f_ODE[R1]\n    x' = -2\n"));
  EXPECT_THAT(pieces, HasSubstr("  f_ODE[R2]\n    x' = 3\n"));
  EXPECT_THAT(printStewart(form, *model), HasSubstr("  y' = theta[1] f_ODE[R1]\n     + theta[2] f_ODE[R2]\n"));
}

constexpr const char *kMany = R"(
model Many
  parameter Integer n = 5;
  coordinate Real x[n], y[n](each start = 1);
  body b[n](each mass = 1, position = {{x[i], y[i]} for i in 1:n});
  contact floor[n](gap = y, slip = der(x), each friction = 0.1);
end Many;
)";

constexpr const char *kPolyhedral = R"(
model Puck
  parameter Integer n = 2;
  coordinate Real q[3];
  body puck(mass = 1, position = q);
  contact table(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.1, frictionForm = FrictionForm.Polyhedral, directions = n);
  friction belt(slip = {der(q[1]) - 1, der(q[2])}, bound = 2, frictionForm = FrictionForm.Relaxed, slipRadius = 0.25);
end Puck;
)";

TEST(PiecewiseForm, PolyhedralFrictionHasAFieldForEachCorner) {
  DerivedModel model(kPolyhedral);
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  const std::string pieces = printPiecewise(form, *model), step = printStep(form, *model);
  EXPECT_THAT(pieces, HasSubstr("slip of table in direction 2\n"));
  EXPECT_THAT(pieces, HasSubstr(" - 0.25  slip of belt\n"));
  EXPECT_THAT(pieces, HasSubstr("= f_aux,n - f_aux,t[1] + f_aux,t[2]  (time is frozen)\n"));
  EXPECT_THAT(step, HasSubstr("  theta[2] = (1 - alpha[1])*(1 - alpha[2])\n"
                              "  theta[3] = (1 - alpha[1])*(1 - alpha[2])*alpha[3]\n"));
  EXPECT_THAT(step, HasSubstr(" + theta[2]*f_aux,n + theta[3]*(-f_aux,t[1]) + theta[4]*f_aux,t[1] + "));
}

TEST(StewartForm, PolyhedralFrictionBeyondTheLimitIsPrintedPerDirection) {
  DerivedModel model(R"(
model Puck
  coordinate Real q[3];
  body puck(mass = 1, position = q);
  contact table(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.1, frictionForm = FrictionForm.Polyhedral, directions = 16);
end Puck;
)");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  const std::string stewart = printStewart(form, *model);
  EXPECT_THAT(stewart, HasSubstr("  table: columns c[1], c[2], c[18]\n"));
  EXPECT_THAT(stewart, HasSubstr("  [ -1 -1  1 ]  f_aux,n - f_aux,t[16]\n"));
  EXPECT_THAT(printPiecewise(form, *model), HasSubstr("  f_aux,t[16] in Q ∩ {y | c[18] < 0}\n"));
}

TEST(PiecewiseForm, ManySwitchingFunctionsArePrintedPerContact) {
  DerivedModel model(kMany);
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(form.terms.size(), 11U);
  EXPECT_EQ(verify(form, *model), "");
  const std::string pieces = printPiecewise(form, *model), stewart = printStewart(form, *model);
  EXPECT_THAT(pieces, HasSubstr("more than 12 switching functions"));
  EXPECT_THAT(pieces, HasSubstr("  f_aux,n(floor[5]) - f_aux,t(floor[5]) in Q5 ∩ {y | c[15] > 0}\n"));
  EXPECT_THAT(stewart, HasSubstr("more than 12 switching functions"));
  EXPECT_THAT(stewart, HasSubstr("  [ -1 -1  1 ]  f_aux,n(floor[5]) - f_aux,t(floor[5])\n"));
  EXPECT_THAT(stewart, Not(HasSubstr("theta[1] ")));
}

TEST(Forms, MassMatrixIsShownWhereItCouples) {
  DerivedModel model("model M\n  coordinate Real x, a;\n  body b(mass = 2, position = {x + sin(a), -cos(a)});\n"
                     "  contact wall(gap = x + 2);\nend M;\n");
  TF_ASSERT_DERIVED(model);
  const std::string text = printStep(timeFreezing(*model), *model);
  EXPECT_THAT(text, HasSubstr("v' = inverse(M)*("));
  EXPECT_THAT(text, HasSubstr("  M[2,1] = "));
}

}  // namespace
}  // namespace tf::filippov
