// Runs the files of tests/conformance: `// expect: ok` or `// expect: CODE at line:column` lines at the top tell the outcome.
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

}  // namespace
}  // namespace tf::test
