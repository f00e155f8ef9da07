// Runs the files of tests/conformance: `// expect: ok` or `// expect: CODE at line:column` lines at the top tell the outcome of the
// front end. Rules that are checked while the equations are derived (TF05, TF06) have their tests in tests/unit/compiler/mechanics.
#include "tests/unit/lang/semantics/instantiate_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

std::vector<std::filesystem::path> conformanceFiles() {
  std::vector<std::filesystem::path> files;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(std::string(TF_SOURCE_DIR) + "/tests/conformance"))
    if (entry.path().extension() == ".tf" && readFile(entry.path()).starts_with("// expect:"))
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::vector<std::string> expectations(const std::string &text) {
  static const std::string kPrefix = "// expect: ";
  std::vector<std::string> expected;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && line.starts_with("//");)
    if (line.starts_with(kPrefix) && line != kPrefix + "ok")
      expected.push_back(line.substr(kPrefix.size()));
  return expected;
}

class Conformance : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(Conformance, givesTheExpectedOutcome) {
  const std::string text = readFile(GetParam());
  Outcome outcome;
  instantiateFiles(outcome, {GetParam().string()}, headerValue(text, "model"));
  const std::vector<std::string> expected = expectations(text);
  EXPECT_THAT(outcome.positions(), ::testing::UnorderedElementsAreArray(expected)) << render(outcome.diagnostics, outcome.sources);
  if (!expected.empty())
    return;
  ASSERT_TRUE(outcome.instantiation.model.has_value());
  EXPECT_EQ(flat::verify(*outcome.instantiation.model), "");
}

std::string nameOf(const ::testing::TestParamInfo<std::filesystem::path> &info) {
  std::string name = info.param.parent_path().filename().string() + "_" + info.param.stem().string();
  std::ranges::replace_if(name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, Conformance, ::testing::ValuesIn(conformanceFiles()), nameOf);

// Every example of the reference's chapters is a correct model.
TEST(ReferenceChapters, examplesInstantiate) {
  int examples = 0;
  for (const auto &entry : std::filesystem::directory_iterator(std::string(TF_SOURCE_DIR) + "/lang/reference")) {
    if (entry.path().extension() != ".md")
      continue;
    static const std::string kFence = "```modelica\n";
    const std::string page = readFile(entry.path());
    for (std::size_t at = page.find(kFence); at != std::string::npos; at = page.find(kFence, at + 1)) {
      const std::size_t begin = at + kFence.size();
      const std::string example = page.substr(begin, page.find("```", begin) - begin);
      const Workspace workspace;
      Outcome choice;
      instantiateText(choice, workspace, example);
      const auto &candidates = choice.instantiation.candidates;
      Outcome outcome;
      instantiateText(outcome, workspace, example, candidates.empty() ? "" : candidates.back());
      EXPECT_EQ(outcome.rendered(workspace), "") << entry.path();
      EXPECT_TRUE(outcome.instantiation.model.has_value()) << entry.path();
      ++examples;
    }
  }
  EXPECT_GE(examples, 8);
}

}  // namespace
}  // namespace tf::test
