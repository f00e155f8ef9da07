// The cache of compiled models: found again, and never when anything that it was made from has changed.
#include "tests/support/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

using testing::HasSubstr;

constexpr const char *kModel =
    "model Growth\n  parameter Integer n = 2 annotation(Evaluate = true);\n  Real x[n](each start = 1, each fixed = true);\n"
    "equation\n  for i in 1:n loop\n    der(x[i]) = 1;\n  end for;\nend Growth;\n";

class Cache : public testing::Test {
protected:
  void SetUp() override { writeFile(folder.path() / "growth.tf", kModel); }

  ProcessResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"run", "growth.tf", "--stop-time", "1"});
    return runProcess(TF_BINARY_DIR "/tfc", arguments, folder.path(), {"TFC_CACHE_DIR=" + (folder.path() / "cache").string()});
  }
  TemporaryFolder folder;
};

TEST_F(Cache, IsUsedByTheSecondRun) {
  const ProcessResult first = run({}), second = run({});
  EXPECT_EQ(first.exitCode, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("(compiled)"));
  EXPECT_THAT(second.err, HasSubstr("(cached)"));
  EXPECT_EQ(first.out, second.out);
  EXPECT_NEAR(finalValue(second, "x[2]"), 2, 1e-9);
}

TEST_F(Cache, NoticesAChangedSource) {
  EXPECT_EQ(run({}).exitCode, 0);
  std::string changed = kModel;
  changed.replace(changed.find("der(x[i]) = 1"), 13, "der(x[i]) = 3");
  writeFile(folder.path() / "growth.tf", changed);
  const ProcessResult result = run({});
  EXPECT_THAT(result.err, HasSubstr("(compiled)"));
  EXPECT_NEAR(finalValue(result, "x[1]"), 4, 1e-9);
}

TEST_F(Cache, KeepsStructuralValuesApart) {
  EXPECT_NEAR(finalValue(run({"--set", "n=3"}), "x[3]"), 2, 1e-9);
  EXPECT_THAT(run({}).out, testing::Not(HasSubstr("x[3]")));
  const ProcessResult again = run({"--set", "n=3"});
  EXPECT_THAT(again.err, HasSubstr("(cached)"));
  EXPECT_NEAR(finalValue(again, "x[3]"), 2, 1e-9);
}

TEST_F(Cache, SharesOneModelAmongValuesOfOtherParametersAndStarts) {
  EXPECT_EQ(run({}).exitCode, 0);
  const ProcessResult result = run({"--set", "x[1]=5"});
  EXPECT_THAT(result.err, HasSubstr("(cached)"));
  EXPECT_NEAR(finalValue(result, "x[1]"), 6, 1e-9);
}

TEST_F(Cache, NoticesAClassThatAppearsBesideTheSource) {
  writeFile(
      folder.path() / "user.tf",
      "model User\n  parameter Real k = Modelica.Constants.pi;\n  Real x(start = 0, fixed = true);\nequation\n  der(x) = k;\nend User;\n");
  const auto user = [&] {
    return runProcess(TF_BINARY_DIR "/tfc", {"run", "user.tf", "--stop-time", "1"}, folder.path(),
                      {"TFC_CACHE_DIR=" + (folder.path() / "cache").string()});
  };
  EXPECT_EQ(user().exitCode, 0);
  EXPECT_THAT(user().err, HasSubstr("(cached)"));
  writeFile(folder.path() / "Modelica.tf",
            "package Modelica\n  package Constants\n    constant Real pi = 3;\n  end Constants;\nend Modelica;\n");
  const ProcessResult changed = user();
  EXPECT_THAT(changed.err, HasSubstr("(compiled)"));
  EXPECT_NEAR(finalValue(changed, "x"), 3, 1e-9);
}

TEST_F(Cache, IsNeitherReadNorWrittenIfUnwanted) {
  EXPECT_EQ(run({"--no-cache"}).exitCode, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "cache"));
  EXPECT_THAT(run({"--no-cache"}).err, HasSubstr("(compiled)"));
}

TEST_F(Cache, IsDoneWithoutWhereItCannotBeWritten) {
  writeFile(folder.path() / "cache", "a file where the folder should be");
  const ProcessResult result = run({});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NEAR(finalValue(result, "x[2]"), 2, 1e-9);
}

// The acceptance of the warm start: a cached model is run without the code generator's library.
TEST_F(Cache, MapsNoCodeGenerator) {
  EXPECT_EQ(run({}).exitCode, 0);
  const ProcessResult traced = runProcess(TF_BINARY_DIR "/tfc", {"run", "growth.tf", "--stop-time", "1"}, folder.path(),
                                          {"TFC_CACHE_DIR=" + (folder.path() / "cache").string(), "LD_DEBUG=files"});
  EXPECT_EQ(traced.exitCode, 0);
  EXPECT_NE(traced.err.find("libtf.so"), std::string::npos);
  EXPECT_EQ(traced.err.find("libtfcodegen"), std::string::npos);
  EXPECT_EQ(traced.err.find("libLLVM"), std::string::npos);
}

}  // namespace
}  // namespace tf::test
