// Every kind of the derivation (TF05xx, TF06xx), with its exact message and range: the example of its page in the reference.
#include "compiler/equations/diagnostics.h"
#include "compiler/mechanics/diagnostics.h"
#include "tests/unit/compiler/mechanics/derived_model.h"

namespace tf::test {
namespace {

namespace eq = equations::diag;
namespace me = mechanics::diag;

// The text between the fence "```kind" and the next one.
std::string fenced(const std::string &page, const std::string &kind) {
  const std::string open = "```" + kind + "\n";
  const std::size_t begin = page.find(open);
  if (begin == std::string::npos)
    return {};
  const std::size_t end = page.find("```", begin + open.size());
  return page.substr(begin + open.size(), end - begin - open.size());
}

std::string trimmed(std::string text) {
  while (!text.empty() && text.back() == '\n')
    text.pop_back();
  return text;
}

std::string pageOf(const DiagnosticKind &kind) {
  return readFile(std::string(TF_SOURCE_DIR) + "/lang/reference/diagnostics/" + kind.code + ".md");
}

class PageOfKind : public ::testing::TestWithParam<const DiagnosticKind *> {};

TEST_P(PageOfKind, ShowsWhatItsExampleGives) {
  const std::string page = pageOf(*GetParam());
  const std::string expected = fenced(page, "text");
  ASSERT_NE(expected.find(std::string("[") + GetParam()->code + "]"), std::string::npos) << "no example of " << GetParam()->name;
  const DerivedModel model(fenced(page, "modelica"));
  EXPECT_EQ(trimmed(model.errors()), trimmed(expected));
  EXPECT_EQ(model.system.has_value(), GetParam()->severity != Severity::Error);
}

INSTANTIATE_TEST_SUITE_P(Derivation, PageOfKind,
                         ::testing::Values(&eq::UndeterminedVariable, &eq::RedundantEquation, &eq::AlgebraicLoop, &eq::ImplicitVariable,
                                           &eq::NonlinearEquation, &eq::VanishingUnknown, &eq::ConstraintEquation, &eq::InitialEquation,
                                           &eq::DerivativeOfInput, &eq::DerivativeOfForce, &eq::EventFunction, &eq::UnsupportedFunction,
                                           &eq::ConditionOnForce, &eq::UnsupportedResult, &eq::StateOnForce, &me::MasslessCoordinate,
                                           &me::SingularMass, &me::NotSmooth, &me::SlipNotAffine, &me::ForbiddenDependency,
                                           &me::GravityDimension, &me::ImmovableGap, &me::ImmovableSlip, &me::ImmovableForce,
                                           &me::VaryingLaw, &me::UncheckedAssertion, &me::ImmovableConstraint, &me::ConstraintNotAffine,
                                           &me::InertiaNotSymmetric, &me::InertiaNotPositive, &me::ZeroRotation, &me::BoundBySlipDirection),
                         [](const auto &kind) { return std::string(kind.param->name); });

TEST(DerivationDiagnostics, AllKindsButThoseTestedByHandHaveExamples) {
  int examples = 0, kinds = 0;
  const auto count = [&](auto &all) {
    for (const DiagnosticKind *kind : all) {
      ++kinds;
      examples += fenced(pageOf(*kind), "text").empty() ? 0 : 1;
    }
  };
  count(eq::kAll);
  count(me::kAll);
  EXPECT_EQ(examples, kinds - 1);
}

// What the language's own rules refuse before, found here again in a flat model that breaks them.
TEST(DerivationDiagnostics, StartThatVaries) {
  DerivedModel model("model M\n  Real z(start = 1);\n  Real a = 2*z;\nequation\n  der(z) = a;\nend M;\n");
  TF_ASSERT_DERIVED(model);
  flat::FlatModel flat = *model.outcome.instantiation.model;
  flat.variables[0].attributes.start = flat.equations[0].right;
  Diagnostics diagnostics;
  EXPECT_FALSE(derive(flat, model.outcome.sources, diagnostics).has_value());
  ASSERT_EQ(diagnostics.all().size(), 1U);
  EXPECT_EQ(diagnostics.all()[0].kind, &me::StartNotParametric);
  EXPECT_EQ(diagnostics.all()[0].message, "the start of 'z' must be given by parameters");
}

TEST(DerivationDiagnostics, SeveralErrorsInOneRun) {
  const DerivedModel model(R"(
model M
  coordinate Real x, y(start = 1);
  body ball(mass = 1, position = {x, y});
  contact left(gap = 1 - time);
  contact floor(gap = y, slip = x);
  force push(value = 1, at = time);
end M;
)");
  EXPECT_EQ(model.outcome.positions(), (std::vector<std::string>{"TF0607 at 5:22", "TF0608 at 6:33", "TF0609 at 7:30"}));
}

// What follows from a variable without an equation is not reported again.
TEST(DerivationDiagnostics, NoCascades) {
  const DerivedModel model("model M\n  Real a = b;\n  Real b = cos(c);\n  Real c = sin(b);\n  Real d = a + c;\nend M;\n");
  EXPECT_EQ(model.outcome.positions(), (std::vector<std::string>{"TF0503 at 3:12"}));
}

// Directly, by a variable of the bound, or by a sign.
TEST(BoundsOfFriction, DoNotDependOnTheDirectionOfTheirSlip) {
  const DerivedModel model(R"(
model M
  coordinate Real x;
  parameter Real belt = 0.3;
  Real slip = 2*(belt - der(x)), rough;
  body block(mass = 1, position = x);
  friction dry(slip = der(x), bound = if der(x) > 0 then 1 else 2);
  friction moved(slip = der(x) - belt, bound = rough);
equation
  rough = 2 + sign(slip);
end M;
)");
  EXPECT_EQ(model.outcome.positions(), (std::vector<std::string>{"TF0619 at 7:42", "TF0619 at 8:48"}));
}

TEST(BoundsOfFriction, DependOnVelocities) {
  const DerivedModel model(R"(
model M
  coordinate Real x, y;
  body a(mass = 1, position = x);
  body b(mass = 1, position = y);
  friction peaked(slip = der(x), bound = 1 + 2*exp(-(der(x)/0.1)^2));
  friction even(slip = der(x), bound = 1 + abs(der(x)));
  friction growing(slip = der(x), bound = if der(x) > 0 then 1 + der(x) else 1);
  friction other(slip = der(x), bound = if der(y) > 0 then 1 else 2);
  friction belt(slip = der(x) - 1, bound = if der(x) > 0 then 1 else 2);
  friction fast(slip = der(x), bound = if der(x) > 1 then 1 else 2);
end M;
)");
  TF_ASSERT_DERIVED(model);
}

}  // namespace
}  // namespace tf::test
