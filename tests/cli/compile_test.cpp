// What `tfc compile` writes.
#include "tests/support/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kParticleFile = TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf";

class CompileCommand : public testing::Test {
protected:
  ProcessResult compile(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"compile", kParticleFile});
    return runTfc(arguments, folder.path());
  }
  TemporaryFolder folder;
};

TEST_F(CompileCommand, MakesASharedLibraryNamedAsTheModel) {
  ASSERT_EQ(compile({}).exitCode, 0);
  EXPECT_THAT(readFile(folder.path() / "Particle.so"), StartsWith("\x7f"
                                                                  "ELF"));
  const ProcessResult run = runTfc({"run", "Particle.so", "--stop-time", "1", "--quiet"}, folder.path());
  EXPECT_EQ(run.exitCode, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("q[2] = 0\n"));
}

TEST_F(CompileCommand, MakesAnObjectFile) {
  ASSERT_EQ(compile({"--emit", "obj"}).exitCode, 0);
  EXPECT_THAT(readFile(folder.path() / "Particle.o"), StartsWith("\x7f"
                                                                 "ELF"));
}

TEST_F(CompileCommand, PrintsTextFormsAndWritesThemIfAsked) {
  for (const char *form : {"ast", "flat", "cls", "pss", "stewart", "step", "llvm-ir", "asm", "header"}) {
    const ProcessResult printed = compile({"--emit", form});
    EXPECT_EQ(printed.exitCode, 0) << form << printed.err;
    EXPECT_GT(printed.out.size(), 100U) << form;
    ASSERT_EQ(compile({"--emit", form, "-o", "form.txt"}).exitCode, 0) << form;
    EXPECT_EQ(readFile(folder.path() / "form.txt"), printed.out) << form;
  }
}

TEST_F(CompileCommand, GivesTheSameBytesAgain) {
  ASSERT_EQ(compile({"-o", "a.so"}).exitCode, 0);
  ASSERT_EQ(compile({"-o", "b.so"}).exitCode, 0);
  EXPECT_EQ(readFile(folder.path() / "a.so"), readFile(folder.path() / "b.so"));
}

TEST_F(CompileCommand, HeaderCompilesAsCAndNumbersTheVariables) {
  ASSERT_EQ(compile({"--emit", "header", "-o", "particle.h"}).exitCode, 0);
  EXPECT_THAT(readFile(folder.path() / "particle.h"), HasSubstr("Particle_der_q_2"));
  writeFile(folder.path() / "use.c",
            "#include \"particle.h\"\nint x[Particle_count_coordinates == 2 ? 1 : -1];\nint y[Particle_time == 0 ? 1 : -1];\n");
  const ProcessResult gcc =
      runProcess("/usr/bin/env", {"cc", "-std=c11", "-Wall", "-Werror", "-pedantic", "-I" TF_SOURCE_DIR, "-c", "use.c"}, folder.path());
  EXPECT_EQ(gcc.exitCode, 0) << gcc.err;
}

TEST_F(CompileCommand, FixesStructuralParameters) {
  const std::string source = TF_SOURCE_DIR "/tests/cli/bad_input/structural.tf";
  ASSERT_EQ(runTfc({"compile", source, "--set", "n=3", "-o", "three.so"}, folder.path()).exitCode, 0);
  EXPECT_THAT(runTfc({"run", "three.so"}, folder.path()).out, HasSubstr("x[3]"));
  const ProcessResult refused = runTfc({"run", "three.so", "--set", "n=2"}, folder.path());
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_EQ(refused.err,
            "error: 'n' is a structural parameter, compiled into 'three.so'; set it where the source is run or compiled  [TF0846]\n");
}

// With another nominal than that of its size the ball would be taken for one that lies on the floor.
TEST_F(CompileCommand, ParametersOfNominalsAreCompiledIn) {
  const std::string source = (folder.path() / "small.tf").string();
  writeFile(source,
            "model Small\n  parameter Real size = 1;\n  coordinate Real y(start = size, nominal = size, der(nominal = size));\n"
            "  body ball(mass = 1, position = y);\n  force weight(value = -size, at = y);\n  contact floor(gap = y);\nend Small;\n");
  const ProcessResult result = runTfc({"run", source, "--set", "size=1e-11", "--quiet"}, folder.path());
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NEAR(finalValue(result, "y") * 1e11, 0.5, 1e-9);
  ASSERT_EQ(runTfc({"compile", source, "-o", "small.so"}, folder.path()).exitCode, 0);
  const ProcessResult compiled = runTfc({"run", "small.so", "--set", "size=1e-11"}, folder.path());
  EXPECT_EQ(compiled.exitCode, 2);
  EXPECT_EQ(compiled.err,
            "error: 'size' is a structural parameter, compiled into 'small.so'; set it where the source is run or compiled  [TF0846]\n");
}

TEST_F(CompileCommand, RefusesToOverwriteItsSource) {
  std::filesystem::copy_file(kParticleFile, folder.path() / "p.tf");
  const ProcessResult result = runTfc({"compile", "p.tf", "-o", "p.tf"}, folder.path());
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(readFile(folder.path() / "p.tf"), readFile(kParticleFile));
}

TEST_F(CompileCommand, OptimizationLevelsAgreeInTheirResults) {
  std::string first;
  for (const char *level : {"0", "1", "2", "3"}) {
    ASSERT_EQ(compile({"-O", level, "-o", "p.so"}).exitCode, 0);
    ASSERT_EQ(
        runTfc({"run", "p.so", "--stop-time", "1", "--set", "mu=0.3", "--set", "der(q[1])=2", "-o", "out.csv"}, folder.path()).exitCode, 0);
    const std::string result = readFile(folder.path() / "out.csv");
    EXPECT_TRUE(first.empty() || first == result) << "-O " << level;
    first = result;
  }
}

}  // namespace
}  // namespace tf::test
