// What `tfc run` does with files, rows, inputs and failures.
#include "tests/support/process.h"
#include "tests/support/result_table.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace tf::test {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kParticle = TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf";

class RunCommand : public testing::Test {
protected:
  ProcessResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"run", kParticle});
    return runTfc(arguments, folder.path());
  }
  ResultTable table(const std::string &name = "out.csv") { return ResultTable(folder.path() / name); }

  TemporaryFolder folder;
};

TEST_F(RunCommand, HasRowsOnTheGridUpToTheStopTime) {
  ASSERT_EQ(run({"--stop-time", "0.35", "--interval", "0.1", "-o", "out.csv"}).exitCode, 0);
  const ResultTable rows = table();
  ASSERT_EQ(rows.rowCount(), 5U);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(rows.value(k, "time"), 0.1 * static_cast<double>(k), 1e-15);
  EXPECT_EQ(rows.value(4, "time"), 0.35);
  EXPECT_EQ(rows.names()[0], "time");
  EXPECT_EQ(rows.names()[1], "tau");
}

TEST_F(RunCommand, EndsAtTheStopTimeHoweverLongTheIntervalIs) {
  ASSERT_EQ(run({"--stop-time", "0.35", "--interval", "1e12", "-o", "out.csv"}).exitCode, 0);
  const ResultTable rows = table();
  ASSERT_EQ(rows.rowCount(), 2U);
  EXPECT_EQ(rows.value(1, "time"), 0.35);
}

TEST_F(RunCommand, HasFiveHundredIntervalsByDefault) {
  ASSERT_EQ(run({"--stop-time", "0.4", "-o", "out.csv"}).exitCode, 0);
  EXPECT_EQ(table().rowCount(), 501U);
}

TEST_F(RunCommand, HasRowsBeforeAndAfterAnImpact) {
  ASSERT_EQ(run({"--stop-time", "1", "--interval", "0.5", "-o", "out.csv"}).exitCode, 0);
  const ResultTable rows = table();
  const double impact = std::sqrt(2 / 9.81), speed = std::sqrt(2 * 9.81);
  std::vector<double> velocities;
  for (std::size_t k = 0; k < rows.rowCount(); ++k) {
    if (std::abs(rows.value(k, "time") - impact) < 1e-8)
      velocities.push_back(rows.value(k, "der(q[2])"));
  }
  ASSERT_GE(velocities.size(), 2U);
  EXPECT_NEAR(velocities.front(), -speed, 1e-7);
  EXPECT_NEAR(velocities.back(), 0, 1e-7);
}

TEST_F(RunCommand, HasOneRowAfterAnImpactIfAsked) {
  ASSERT_EQ(run({"--stop-time", "1", "--interval", "0.5", "--events", "after", "-o", "out.csv"}).exitCode, 0);
  const ResultTable rows = table();
  int count = 0;
  for (std::size_t k = 0; k < rows.rowCount(); ++k) {
    if (std::abs(rows.value(k, "time") - std::sqrt(2 / 9.81)) < 1e-8) {
      ++count;
      EXPECT_NEAR(rows.value(k, "der(q[2])"), 0, 1e-7);
    }
  }
  EXPECT_EQ(count, 1);
}

TEST_F(RunCommand, WritesTheSameToCsvAndJson) {
  ASSERT_EQ(run({"--stop-time", "1", "--interval", "0.25", "-o", "out.csv"}).exitCode, 0);
  ASSERT_EQ(run({"--stop-time", "1", "--interval", "0.25", "-o", "out.json"}).exitCode, 0);
  const ResultTable rows = table();
  const std::string text = readFile(folder.path() / "out.json");
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_THAT(text, HasSubstr("der(q[2])"));
  EXPECT_TRUE(json.is_object());
  EXPECT_NE(text.find(rows.text(rows.rowCount() - 1, "tau")), std::string::npos);
}

TEST_F(RunCommand, WritesTheVariablesThatAreChosen) {
  const std::vector<std::string> arguments = {"--stop-time", "1", "--variables", "der(q[?])", "--variables", "floor.*Force",
                                              "--variables", "m"};
  std::vector<std::string> withFile = arguments;
  withFile.insert(withFile.end(), {"-o", "out.csv", "--sensitivity", "mu", "--sensitivity", "mu"});
  ASSERT_EQ(run(withFile).exitCode, 0);
  const std::string text = readFile(folder.path() / "out.csv");
  EXPECT_EQ(text.substr(0, text.find('\r')),
            "time,der(q[1]),der(q[2]),floor.normalForce,floor.frictionForce,m,d(der(q[1]))/d(mu),d(der(q[2]))/d(mu)");
  const ProcessResult printed = run(arguments);
  EXPECT_EQ(printed.exitCode, 0);
  EXPECT_EQ(printed.out.find("time = 1 s\nder(q[1]) = "), 0U);
  EXPECT_THAT(printed.out, HasSubstr("\nfloor.normalForce = "));
  EXPECT_THAT(printed.out, Not(HasSubstr("\nq[1]")));
}

// The same numbers as in a result of all variables.
TEST_F(RunCommand, ChoosesVariablesWithoutEffectOnThem) {
  ASSERT_EQ(run({"-o", "all.csv"}).exitCode, 0);
  ASSERT_EQ(run({"-o", "some.csv", "--variables", "*q[2]*"}).exitCode, 0);
  const ResultTable all = table("all.csv"), some = table("some.csv");
  ASSERT_EQ(some.rowCount(), all.rowCount());
  for (std::size_t row = 0; row < all.rowCount(); ++row)
    for (const char *name : {"time", "q[2]", "der(q[2])", "der(der(q[2]))"})
      ASSERT_EQ(some.text(row, name), all.text(row, name)) << row << " " << name;
}

TEST_F(RunCommand, PrintsFinalValuesWithoutAResultFile) {
  const ProcessResult result = run({"--stop-time", "1", "--quiet"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_THAT(result.out, HasSubstr("time = 1 s\n"));
  EXPECT_THAT(result.out, HasSubstr("q[2] = 0\n"));
  EXPECT_EQ(result.err, "");
}

TEST_F(RunCommand, SummarisesOnTheStandardError) {
  const ProcessResult result = run({"--stop-time", "1", "-o", "out.csv"});
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("steps"));
  EXPECT_THAT(result.err, HasSubstr("1 impact"));
  EXPECT_THAT(result.err, HasSubstr("compile"));
  EXPECT_THAT(result.err, HasSubstr("initialise"));
  EXPECT_THAT(result.err, HasSubstr("simulate"));
  EXPECT_THAT(result.err, Not(HasSubstr("Jacobians")));
}

TEST_F(RunCommand, TellsMoreIfVerbose) {
  const ProcessResult result = run({"--stop-time", "1", "--verbose", "-o", "out.csv"});
  EXPECT_THAT(result.err, HasSubstr("impact of floor"));
  EXPECT_THAT(result.err, HasSubstr("Jacobians"));
  EXPECT_THAT(result.err, HasSubstr("integrators: explicit 100 % of the time in "));
}

TEST_F(RunCommand, TellsWhichIntegratorTookOver) {
  writeFile(folder.path() / "stiff.tf", "model Stiff\n  coordinate Real x(start = 1), y(start = 1);\n  body a(mass = 1, position = x);\n"
                                        "  body b(mass = 1, position = y);\n  force soft(value = -x, at = x);\n"
                                        "  force stiff(value = -1e6*der(y) - 1e6*(y - x), at = y);\nend Stiff;\n");
  const ProcessResult result = runTfc({"run", "stiff.tf", "--stop-time", "10", "--verbose", "--event-log", "log.csv"}, folder.path());
  EXPECT_THAT(result.err, HasSubstr(" % of the time in "));
  EXPECT_THAT(result.err, HasSubstr(" on cvode: stiff\n"));
  EXPECT_THAT(readFile(folder.path() / "log.csv"), HasSubstr(",integrator,cvode: stiff,"));
}

TEST_F(RunCommand, WarnsOfRedundantConstraints) {
  writeFile(folder.path() / "twice.tf", "model Twice\n  coordinate Real x, y;\n  body a(mass = 1, position = {x, y});\n"
                                        "  constraint first(residual = y);\n  constraint second(residual = 2*y);\nend Twice;\n");
  const ProcessResult result = runTfc({"run", "twice.tf", "--quiet", "--event-log", "log.csv"}, folder.path());
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_THAT(result.err, HasSubstr("warning: constraint 'second' follows from 'first' (twice.tf:5) at time = 0;"));
  EXPECT_THAT(result.err, HasSubstr("[TF0905]"));
  EXPECT_THAT(readFile(folder.path() / "log.csv"), HasSubstr(",redundancy,constraint 'second' follows from 'first' (twice.tf:5),"));
}

// The horizontal position under a force u[1] on m = 1, without friction.
double finalPosition(const ProcessResult &result) { return finalValue(result, "q[1]"); }

TEST_F(RunCommand, TakesInputsFromExpressionsWithBreakpoints) {
  // x'' = 1 for t < 0.3, else 0: x(1) = 0.045 + 0.3·0.7
  EXPECT_NEAR(finalPosition(run({"--stop-time", "1", "--quiet", "--set", "u[1]=if time < 0.3 then 1 else 0"})), 0.255, 1e-9);
  // A square wave of period 0.2 that is 1 in its first half: x(1) = Σ_k 0.1 (1 − 0.2 k − 0.05)
  EXPECT_NEAR(finalPosition(run({"--stop-time", "1", "--quiet", "--set", "u[1]=if mod(time, 0.2) < 0.1 then 1 else 0"})), 0.275, 1e-9);
  // max(0, t − 1/2): x(1) = 0.5³/6
  EXPECT_NEAR(finalPosition(run({"--stop-time", "1", "--quiet", "--set", "u[1]=max(0, time-0.5)"})), 0.125 / 6, 1e-9);
  // Zeros that are no closed forms: sin(2π t) > 0.5 between 1/12 and 5/12, so x(1) = (1/3)²/2 + (1/3)(7/12)
  EXPECT_NEAR(finalPosition(run({"--stop-time", "1", "--quiet", "--set", "u[1]=if sin(6.283185307179586*time) > 0.5 then 1 else 0"})),
              1.0 / 18 + 7.0 / 36, 1e-9);
  // Parameters as they are set: g = 2, x'' = 2 g = 4
  EXPECT_NEAR(finalPosition(run({"--stop-time", "0.5", "--quiet", "--set", "u[1]=2*g", "--set", "g=2"})), 0.5, 1e-9);
}

TEST_F(RunCommand, SetsParametersByExpressionsOfParameters) {
  // m = 2 g = 8 and force 8: x'' = 1
  EXPECT_NEAR(finalPosition(run({"--stop-time", "0.5", "--quiet", "--set", "m=2*g", "--set", "g=4", "--set", "u[1]=8"})), 0.125, 1e-9);
}

TEST_F(RunCommand, ReportsAFullDiskAndAnUnwritablePlace) {
  const ProcessResult missing = run({"-o", "no/such/folder/out.csv"});
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_THAT(missing.err, HasSubstr("TF0821"));
  EXPECT_THAT(missing.err, HasSubstr("no/such/folder/out.csv"));
  for (const char *name : {"full.csv", "full.json"}) {
    std::filesystem::create_symlink("/dev/full", folder.path() / name);
    for (const std::vector<std::string> &options : {std::vector<std::string>{"-o", name}, {"-o", "out.csv", "--event-log", "full.csv"}}) {
      const ProcessResult full = run(options);
      EXPECT_EQ(full.exitCode, 3) << name;
      EXPECT_THAT(full.err, HasSubstr("TF0903"));
      EXPECT_THAT(full.err, HasSubstr("No space left"));
    }
  }
}

TEST_F(RunCommand, StopsWhereItsResultCannotBeWrittenAnyMore) {
  ASSERT_EQ(runTfc({"compile", kParticle}, folder.path()).exitCode, 0);
  // 8 blocks of 512 or 1024 bytes; the signal of the limit is ignored, so that writing fails.
  const std::string command = "trap '' XFSZ; ulimit -f 8; exec '" TF_BINARY_DIR "/tfc' run Particle.so -o out.csv";
  const ProcessResult result = runProcess("/bin/sh", {"-c", command}, folder.path());
  EXPECT_EQ(result.exitCode, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("TF0903"));
  EXPECT_GT(std::filesystem::file_size(folder.path() / "out.csv"), 1000U);
}

TEST_F(RunCommand, SaysWhatCodeGenerationMisses) {
  const ProcessResult result =
      runProcess(TF_BINARY_DIR "/tfc", {"compile", kParticle}, folder.path(), {"TMPDIR=" + (folder.path() / "no/such").string()});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.err, HasSubstr("TF0829"));
  EXPECT_THAT(result.err, HasSubstr("temporary directory"));
}

TEST_F(RunCommand, SaysThatTheCodeGeneratorIsMissing) {
  const std::filesystem::path build = TF_BINARY_DIR;
  for (const char *file : {"tfc", "libtf.so"})
    std::filesystem::copy_file(build / file, folder.path() / file);
  const ProcessResult result = runProcess(folder.path() / "tfc", {"run", kParticle}, folder.path(), {"TFC_CACHE_DIR="});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.err, HasSubstr("TF0828"));
  EXPECT_THAT(result.err, HasSubstr("libtfcodegen.so"));
}

TEST_F(RunCommand, KeepsRowsFromBeforeAFailure) {
  writeFile(folder.path() / "blowup.tf", "model Blowup\n  Real x(start = 1, fixed = true);\nequation\n  der(x) = x^2;\nend Blowup;\n");
  const ProcessResult result = runTfc({"run", "blowup.tf", "--stop-time", "2", "--interval", "0.25", "-o", "out.csv"}, folder.path());
  EXPECT_EQ(result.exitCode, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("TF0902"));
  const ResultTable rows = table();
  ASSERT_GE(rows.rowCount(), 4U);
  EXPECT_NEAR(rows.value(rows.rowAt(0.75), "x"), 4, 1e-4);  // x = 1/(1 − t)
}

TEST_F(RunCommand, ReadsTablesWithHoldAndLinearInterpolation) {
  writeFile(folder.path() / "u.csv", "time,\"u[1]\"\r\n0,0\r\n1,1\r\n");
  EXPECT_NEAR(finalPosition(run({"--stop-time", "1", "--quiet", "--input", "u.csv", "--input-interpolation", "linear"})), 1.0 / 6, 1e-9);
  EXPECT_NEAR(finalPosition(run({"--stop-time", "1", "--quiet", "--input", "u.csv"})), 0, 1e-12);
}

TEST_F(RunCommand, StartsWhereAsked) {
  ASSERT_EQ(run({"--start-time", "2", "--stop-time", "2.25", "--interval", "0.25", "-o", "out.csv"}).exitCode, 0);
  const ResultTable rows = table();
  EXPECT_EQ(rows.value(0, "time"), 2);
  EXPECT_EQ(rows.value(rows.rowCount() - 1, "time"), 2.25);
  EXPECT_NEAR(rows.value(rows.rowCount() - 1, "q[2]"), 1 - 9.81 * 0.25 * 0.25 / 2, 1e-9);
}

TEST_F(RunCommand, ReportsInvariants) {
  const ProcessResult result = runTfc({"run", TF_SOURCE_DIR "/examples/incline.tf", "--check-invariants", "--quiet"}, folder.path());
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("least gap of "));
  EXPECT_THAT(result.err, HasSubstr("least normal force of 17 in 'plane'"));
  EXPECT_THAT(result.err, HasSubstr("in the energy balance at time = "));
}

}  // namespace
}  // namespace tf::test
