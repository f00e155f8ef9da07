#include "runtime/results/result_writer.h"

#include "runtime/results/event_log.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>

namespace tf::runtime {

namespace {

const double infinity = std::numeric_limits<double>::infinity();

std::string contents(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// A folder of its own for each test.
class ResultFiles : public testing::Test {
protected:
  ResultFiles() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tf_results_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~ResultFiles() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string &name) const { return (folder_ / name).string(); }

private:
  std::filesystem::path folder_;
};

// Variables by number, under their names.
std::vector<ResultColumn> columns(const tf_model &model, const std::vector<std::int32_t> &numbers) {
  std::vector<ResultColumn> result;
  for (const std::int32_t number : numbers)
    result.push_back({number, 1, model.variables[number].name, model.variables[number].description, model.variables[number].unit});
  return result;
}

std::vector<double> numbered(const tf_model &model) {
  std::vector<double> values(static_cast<std::size_t>(model.variable_count));
  std::iota(values.begin(), values.end(), 0.0);
  return values;
}

TEST(Numbers, ReadBackAsTheSameDouble) {
  std::mt19937_64 bits(7);
  for (int i = 0; i < 10000; ++i) {
    const double value = std::bit_cast<double>(bits());
    if (!std::isfinite(value))
      continue;
    std::string text;
    appendNumber(text, value);
    double read = 0;
    std::from_chars(text.data(), text.data() + text.size(), read);
    EXPECT_EQ(read, value) << text;
  }
}

TEST(Numbers, AreShort) {
  std::string text;
  for (const double value : {0.1, 1.0, -0.0, 1e300, infinity, -infinity, std::nan("")}) {
    appendNumber(text, value);
    text += ' ';
  }
  EXPECT_EQ(text, "0.1 1 0 1e+300 inf -inf nan ");
}

TEST(CsvFields, AreQuotedOnlyWhereNeeded) {
  std::string text;
  for (const char *field : {"u[1]", "a[1,2]", "say \"hi\"", "two\nlines"}) {
    appendCsvField(text, field);
    text += ';';
  }
  EXPECT_EQ(text, "u[1];\"a[1,2]\";\"say \"\"hi\"\"\";\"two\nlines\";");
}

TEST_F(ResultFiles, CsvRowsAreThereAsSoonAsTheyAreWritten) {
  auto writer = ResultWriter::create(path("out.csv"), test::particleModel(), columns(test::particleModel(), {0, 2, 5}));
  ASSERT_TRUE(writer.ok()) << writer.error();
  EXPECT_TRUE(writer.value()->writeRow(numbered(test::particleModel())).ok());
  EXPECT_EQ(contents(path("out.csv")), "time,q[1],der(q[2])\r\n0,2,5\r\n");
  EXPECT_TRUE(writer.value()->finish().ok());
  EXPECT_EQ(contents(path("out.csv")), "time,q[1],der(q[2])\r\n0,2,5\r\n");
}

// Whatever part of a row is that of the one before, beside zeros of both signs and numbers that are none.
TEST_F(ResultFiles, CsvRowsRepeatNumbers) {
  auto writer = ResultWriter::create(path("out.csv"), test::particleModel(), columns(test::particleModel(), {0, 2, 5}));
  ASSERT_TRUE(writer.ok()) << writer.error();
  std::vector<double> values = numbered(test::particleModel());
  std::string expected = "time,q[1],der(q[2])\r\n";
  const std::vector<std::pair<std::array<double, 3>, std::string>> rows = {{{0, -0.0, 1.25}, "0,0,1.25"},
                                                                           {{-0.0, 0, 1.25}, "0,0,1.25"},
                                                                           {{123.5, 0, 1.25}, "123.5,0,1.25"},
                                                                           {{123.5, 0, 1.25}, "123.5,0,1.25"},
                                                                           {{1, -infinity, 5}, "1,-inf,5"},
                                                                           {{1, -infinity, 6}, "1,-inf,6"},
                                                                           {{1, 77, 6}, "1,77,6"},
                                                                           {{1, NAN, 6}, "1,nan,6"},
                                                                           {{2, NAN, 0}, "2,nan,0"}};
  for (const auto &[numbers, text] : rows) {
    values[0] = numbers[0];
    values[2] = numbers[1];
    values[5] = numbers[2];
    EXPECT_TRUE(writer.value()->writeRow(values).ok());
    expected += text + "\r\n";
  }
  EXPECT_EQ(contents(path("out.csv")), expected);
}

TEST_F(ResultFiles, JsonHasVariablesAndColumns) {
  auto writer = ResultWriter::create(path("out.JSON"), test::particleModel(), columns(test::particleModel(), {0, 2, 8}));
  ASSERT_TRUE(writer.ok()) << writer.error();
  auto values = numbered(test::particleModel());
  EXPECT_TRUE(writer.value()->writeRow(values).ok());
  values[2] = infinity;
  values[8] = std::nan("");
  EXPECT_TRUE(writer.value()->writeRow(values).ok());
  EXPECT_TRUE(writer.value()->finish().ok());
  const auto json = nlohmann::json::parse(contents(path("out.JSON")));
  EXPECT_EQ(json["model"], "Particle");
  ASSERT_EQ(json["variables"].size(), 3u);
  EXPECT_EQ(json["variables"][1], (nlohmann::json{{"name", "q[1]"}, {"unit", "m"}, {"description", ""}}));
  EXPECT_EQ(json["variables"][2]["description"], "applied force");
  EXPECT_EQ(json["data"]["q[1]"], (nlohmann::json{2, "inf"}));
  EXPECT_EQ(json["data"]["u[1]"], (nlohmann::json{8, "nan"}));
}

TEST_F(ResultFiles, JsonIsWholeWithoutRowsAndWithoutFinish) {
  {
    ASSERT_TRUE(ResultWriter::create(path("out.json"), test::relayModel(), columns(test::relayModel(), {0})).ok());
  }
  EXPECT_EQ(nlohmann::json::parse(contents(path("out.json")))["data"]["time"].size(), 0u);
}

TEST_F(ResultFiles, RefusesUnknownSuffixesAndUnwritablePlaces) {
  const auto error = [](const std::string &file) {
    const auto writer = ResultWriter::create(file, test::relayModel(), columns(test::relayModel(), {0}));
    return writer.ok() ? "no error" : writer.error();
  };
  EXPECT_EQ(error("out.txt"), "cannot write results to 'out.txt': the name must end in .csv or .json");
  EXPECT_EQ(error("csv"), "cannot write results to 'csv': the name must end in .csv or .json");
  EXPECT_EQ(error("results.csv/out"), "cannot write results to 'results.csv/out': the name must end in .csv or .json");
  const std::string missing = path("nowhere/out.csv");
  EXPECT_EQ(error(missing), "cannot write '" + missing + "': No such file or directory");
  const auto empty = ResultWriter::create(path("out.csv"), test::relayModel(), columns(test::relayModel(), {}));
  EXPECT_FALSE(empty.ok());
}

// /dev/full is a disk that is always full.
TEST_F(ResultFiles, ReportsAFullDisk) {
  std::filesystem::create_symlink("/dev/full", path("full.csv"));
  std::filesystem::create_symlink("/dev/full", path("full.json"));
  auto csv = ResultWriter::create(path("full.csv"), test::relayModel(), columns(test::relayModel(), {0}));
  ASSERT_TRUE(csv.ok());
  EXPECT_EQ(csv.value()->writeRow(numbered(test::relayModel())).error(),
            "cannot write to '" + path("full.csv") + "': No space left on device");
  auto json = ResultWriter::create(path("full.json"), test::relayModel(), columns(test::relayModel(), {0}));
  ASSERT_TRUE(json.ok());
  EXPECT_EQ(json.value()->finish().error(), "cannot write to '" + path("full.json") + "': No space left on device");
}

TEST(VisibleColumns, LeaveOutProtectedVariables) {
  tf_model model = test::relayModel();
  std::vector<tf_variable> variables(model.variables, model.variables + model.variable_count);
  variables[3].flags |= TF_PROTECTED;
  model.variables = variables.data();
  const auto visible = visibleColumns(model);
  ASSERT_EQ(visible.size(), variables.size() - 1);
  for (const ResultColumn &column : visible) {
    EXPECT_NE(column.variable, 3);
    EXPECT_STREQ(column.name, variables[static_cast<std::size_t>(column.variable)].name);
  }
}

TEST_F(ResultFiles, OtherNamesAreColumnsAfterTheVariables) {
  const tf_model &model = test::particleModel();
  auto visible = visibleColumns(model);
  ASSERT_EQ(visible.size(), static_cast<std::size_t>(model.variable_count + model.alias_count));
  visible.erase(visible.begin() + 1, visible.begin() + model.variable_count);
  auto writer = ResultWriter::create(path("out.csv"), model, visible);
  ASSERT_TRUE(writer.ok()) << writer.error();
  EXPECT_TRUE(writer.value()->writeRow(numbered(model)).ok());
  EXPECT_EQ(contents(path("out.csv")), "time,x,vy,depth\r\n0,2,5,-3\r\n");
}

TEST_F(ResultFiles, EventLogHasStatesBeforeAndAfter) {
  auto log = EventLog::create(path("events.csv"), test::beltModel());
  ASSERT_TRUE(log.ok()) << log.error();
  const double before[] = {0.5, -1}, after[] = {0.5, 0};
  EXPECT_TRUE(log.value()->write({1.25, 2.5, TF_EVENT_SLIP_REVERSAL, 0, before, after}).ok());
  EXPECT_TRUE(log.value()->write({2, 3, TF_EVENT_TERMINATE, -1, after, after}).ok());
  EXPECT_TRUE(log.value()->finish().ok());
  EXPECT_EQ(contents(path("events.csv")), "time,tau,kind,element,x-,x+,der(x)-,der(x)+\r\n"
                                          "1.25,2.5,slip reversal,dry,0.5,0.5,-1,0\r\n"
                                          "2,3,terminate,,0.5,0.5,0,0\r\n");
}

TEST(EventNames, AreThoseOfTheReference) {
  std::vector<std::string_view> names;
  for (int kind = 0; kind < TF_EVENT_COUNT; ++kind)
    names.push_back(eventKindName(static_cast<tf_event_kind>(kind)));
  EXPECT_THAT(names, testing::ElementsAre("impact", "opening", "closing", "stick", "slip", "slip reversal", "sliding", "rest", "painleve",
                                          "time", "state", "terminate"));
  EXPECT_EQ(eventElementName(test::relayModel(), 0), "x > 0");
  EXPECT_EQ(eventElementName(test::boxModel(), 2), "corner[3]");
}

}  // namespace

}  // namespace tf::runtime
