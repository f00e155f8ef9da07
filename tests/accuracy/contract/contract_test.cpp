// The cases of cases.json: models with closed-form answers, run as a user runs them, from source and compiled, with every integrator.
#include "tests/support/process.h"
#include "tests/support/result_table.h"

#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace tf::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kFolder = TF_SOURCE_DIR "/tests/accuracy/contract";

struct Case {
  json data;
  bool isCompiled;
  std::string integrator;
};

void PrintTo(const Case &c, std::ostream *stream) { *stream << c.data["name"]; }

std::vector<Case> allCases() {
  std::vector<Case> cases;
  const json file = json::parse(readFile(kFolder / "cases.json"));
  for (const json &data : file["cases"]) {
    for (const bool isCompiled : {false, true}) {
      for (const char *integrator : {"step", "explicit", "cvode", "auto"})
        cases.push_back({data, isCompiled, integrator});
    }
  }
  return cases;
}

std::string caseName(const testing::TestParamInfo<Case> &info) {
  std::string name =
      info.param.data["name"].get<std::string>() + (info.param.isCompiled ? " compiled " : " source ") + info.param.integrator;
  std::replace_if(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

std::vector<std::string> arguments(const Case &c, const std::string &model, const fs::path &folder) {
  std::vector<std::string> result = {"run", model};
  for (std::string argument : c.data["args"]) {
    if (const std::size_t place = argument.find("{dir}"); place != std::string::npos)
      argument.replace(place, 5, kFolder.string());
    result.push_back(argument);
  }
  for (const std::string &argument :
       {std::string("--interval"), std::string("0.1"), std::string("--integrator"), c.integrator, std::string("-o"),
        (folder / "out.csv").string(), std::string("--event-log"), (folder / "events.csv").string()})
    result.push_back(argument);
  return result;
}

void checkValues(const json &checks, const ResultTable &table) {
  for (const json &check : checks) {
    const double expected = check["value"], tolerance = check.value("tolerance", 1e-7);
    const std::string variable = check["variable"];
    const double actual = table.value(table.rowAt(check["time"]), variable);
    EXPECT_NEAR(actual, expected, tolerance * std::max(1.0, std::abs(expected))) << variable << " at time " << check["time"];
  }
}

void checkEvents(const json &events, const ResultTable &log) {
  for (const json &event : events) {
    const std::string kind = event["kind"];
    double nearest = INFINITY;
    for (std::size_t row = 0; row < log.rowCount(); ++row) {
      if (log.text(row, "kind") == kind)
        nearest = std::min(nearest, std::abs(log.value(row, "time") - event["time"].get<double>()));
    }
    EXPECT_LE(nearest, event.value("tolerance", 1e-8)) << kind << " at time " << event["time"];
  }
}

class Contract : public testing::TestWithParam<Case> {};

TEST_P(Contract, HasTheClosedFormsValues) {
  const Case &c = GetParam();
  const TemporaryFolder folder;
  const std::string model = c.data["model"];
  std::string file = (kFolder / model).string();
  ProcessResult result;
  if (c.isCompiled) {
    const std::string library = (folder.path() / "model.so").string();
    result = runTfc({"compile", file, "-o", library}, folder.path());
    file = library;
  }
  if (!c.isCompiled || result.exitCode == 0)
    result = runTfc(arguments(c, file, folder.path()), folder.path());

  ASSERT_EQ(result.exitCode, 0) << result.err;
  checkValues(c.data["checks"], ResultTable(folder.path() / "out.csv"));
  if (c.data.contains("events"))
    checkEvents(c.data["events"], ResultTable(folder.path() / "events.csv"));
}

INSTANTIATE_TEST_SUITE_P(Cases, Contract, testing::ValuesIn(allCases()), caseName);

}  // namespace
}  // namespace tf::test
