// Every kind of diagnostic has a page in the reference whose example gives exactly the text that the page shows.
#include "lang/semantics/diagnostics.h"
#include "tests/unit/lang/semantics/instantiate_text.h"

#include <gtest/gtest.h>

namespace tf::test {
namespace {

std::filesystem::path pageOf(const DiagnosticKind &kind) {
  return std::string(TF_SOURCE_DIR) + "/lang/reference/diagnostics/" + kind.code + ".md";
}

// The text of the first block that starts with ```language.
std::string block(const std::string &page, const std::string &language) {
  const std::string fence = "```" + language + "\n";
  const std::size_t begin = page.find(fence);
  if (begin == std::string::npos)
    return {};
  const std::size_t end = page.find("\n```", begin + fence.size());
  return page.substr(begin + fence.size(), end - begin - fence.size() + 1);
}

class DiagnosticPage : public ::testing::TestWithParam<const DiagnosticKind *> {};

TEST_P(DiagnosticPage, showsWhatTheExampleGives) {
  const DiagnosticKind &kind = *GetParam();
  const std::string page = readFile(pageOf(kind));
  ASSERT_TRUE(page.starts_with("# " + std::string(kind.code) + ": ")) << pageOf(kind);
  const std::string example = block(page, "modelica");
  if (&kind == &semantics::diag::CannotRead)
    return;
  ASSERT_NE(example, "");
  const Workspace workspace;
  Outcome outcome;
  instantiateText(outcome, workspace, example, headerValue(example, "model"));
  EXPECT_EQ(outcome.rendered(workspace), block(page, "text"));
  EXPECT_NE(outcome.rendered(workspace).find("[" + std::string(kind.code) + "]"), std::string::npos);
  EXPECT_EQ(outcome.instantiation.model.has_value(), !outcome.diagnostics.hasErrors());
}

std::string kindNameOf(const ::testing::TestParamInfo<const DiagnosticKind *> &info) { return info.param->name; }

INSTANTIATE_TEST_SUITE_P(Kinds, DiagnosticPage, ::testing::ValuesIn(semantics::diag::kAll), kindNameOf);

TEST(Diagnostics, codesAreUniqueAndOrdered) {
  for (std::size_t i = 1; i < std::size(semantics::diag::kAll); ++i)
    EXPECT_LT(std::string(semantics::diag::kAll[i - 1]->code), semantics::diag::kAll[i]->code);
}

TEST(Diagnostics, aFileThatIsNotThere) {
  Outcome outcome;
  instantiateFiles(outcome, {"no/such/file.tf"});
  ASSERT_EQ(outcome.diagnostics.all().size(), 1U);
  EXPECT_EQ(outcome.diagnostics.all()[0].message, "cannot read 'no/such/file.tf'");
  EXPECT_FALSE(outcome.instantiation.model.has_value());
}

}  // namespace
}  // namespace tf::test
