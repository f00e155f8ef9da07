// Results are bit-identical from run to run, and between code in memory and in a shared library.
#include "tests/support/process.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tf::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> examples() {
  std::vector<std::string> names;
  for (const fs::directory_entry &entry : fs::directory_iterator(fs::path(TF_SOURCE_DIR) / "examples"))
    if (entry.path().extension() == ".tf")
      names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class IdenticalResults : public testing::TestWithParam<std::string> {};

TEST_P(IdenticalResults, InMemoryAgainAndInASharedLibrary) {
  const TemporaryFolder folder;
  const std::string source = (fs::path(TF_SOURCE_DIR) / "examples" / (GetParam() + ".tf")).string();
  const auto resultOf = [&](const std::string &model) {
    const ProcessResult result =
        runTfc({"run", model, "--no-cache", "--quiet", "-o", "result.csv", "--event-log", "events.csv"}, folder.path());
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return readFile(folder.path() / "result.csv") + readFile(folder.path() / "events.csv");
  };
  ASSERT_EQ(runTfc({"compile", source, "-o", "model.so"}, folder.path()).exitCode, 0);
  const std::string first = resultOf(source), again = resultOf(source), shared = resultOf("model.so");
  EXPECT_GT(first.size(), 1000U);
  EXPECT_TRUE(first == again);
  EXPECT_TRUE(first == shared);
}

INSTANTIATE_TEST_SUITE_P(Examples, IdenticalResults, testing::ValuesIn(examples()),
                         [](const testing::TestParamInfo<std::string> &example) { return example.param; });

}  // namespace
}  // namespace tf::test
