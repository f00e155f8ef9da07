#include "runtime/results/csv_reader.h"

#include "tests/unit/runtime/hand_written_models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <random>

namespace tf::runtime {

namespace {

using testing::ElementsAre;

Outcome<std::vector<InputTable>> parse(std::string_view text) {
  static const ModelInstance instance(test::particleModel());
  return parseInputTables(text, "u.csv", instance);
}

TEST(CsvReader, ReadsQuotedNamesAnyColumnOrderAndNumbers) {
  const auto tables = parse("\"u[2]\",time,u[1]\n1e-3,0,-2.5\n+4,0.5,\"7\"\n");
  ASSERT_TRUE(tables.ok()) << tables.error();
  ASSERT_EQ(tables.value().size(), 2u);
  EXPECT_EQ(tables.value()[0].input, 1);
  EXPECT_THAT(tables.value()[0].times, ElementsAre(0, 0.5));
  EXPECT_THAT(tables.value()[0].values, ElementsAre(1e-3, 4));
  EXPECT_EQ(tables.value()[1].input, 0);
  EXPECT_THAT(tables.value()[1].values, ElementsAre(-2.5, 7));
}

TEST(CsvReader, AcceptsByteOrderMarkCarriageReturnsBlankLinesBlanksAndNoFinalLineEnd) {
  const auto tables = parse("\xEF\xBB\xBF\r\ntime , u[ 1 ]\r\n\r\n 0,\t1 \r\n1,2");
  ASSERT_TRUE(tables.ok()) << tables.error();
  EXPECT_THAT(tables.value()[0].times, ElementsAre(0, 1));
  EXPECT_THAT(tables.value()[0].values, ElementsAre(1, 2));
}

TEST(CsvReader, AcceptsLinesThatEndWithCarriageReturnsAlone) {
  const ModelInstance instance(test::particleModel());
  const auto tables = parseInputTables("time,u[1]\r0,1\r\r2,3\r", "u.csv", instance);
  ASSERT_TRUE(tables) << tables.error();
  EXPECT_EQ(tables.value()[0].times, (std::vector<double>{0, 2}));
  EXPECT_EQ(tables.value()[0].values, (std::vector<double>{1, 3}));
  EXPECT_EQ(parseInputTables("time,u[1]\r0,x\r", "u.csv", instance).error(), "u.csv:2:3: column 'u[1]' needs a number, found 'x'");
}

TEST(CsvReader, KeepsEqualTimesAsJumps) {
  const auto tables = parse("time,u[1]\n0,1\n1,1\n1,5\n");
  ASSERT_TRUE(tables.ok()) << tables.error();
  EXPECT_THAT(tables.value()[0].times, ElementsAre(0, 1, 1));
}

TEST(CsvReader, ReadsBooleansAsWordsOrNumbers) {
  std::vector<tf_variable> variables(test::particleModel().variables,
                                     test::particleModel().variables + test::particleModel().variable_count);
  for (tf_variable &variable : variables)
    if (std::string_view(variable.name) == "u[1]")
      variable.flags |= TF_BOOLEAN;
  tf_model model = test::particleModel();
  model.variables = variables.data();
  const ModelInstance instance(model);
  const auto tables = parseInputTables("time,u[1],u[2]\n0,true,1\n1,false,2\n2,True,3\n3,0,4\n4,\"TRUE\",5\n", "u.csv", instance);
  ASSERT_TRUE(tables.ok()) << tables.error();
  EXPECT_THAT(tables.value()[0].values, ElementsAre(1, 0, 1, 0, 1));
  EXPECT_EQ(parseInputTables("time,u[1]\n0,yes\n", "u.csv", instance).error(), "u.csv:2:3: column 'u[1]' needs true or false, found 'yes'");
  EXPECT_EQ(parseInputTables("time,u[2]\n0,true\n", "u.csv", instance).error(), "u.csv:2:3: column 'u[2]' needs a number, found 'true'");
}

struct BadTable {
  const char *text, *message;
};

void PrintTo(const BadTable &one, std::ostream *stream) { *stream << one.message; }

class CsvReaderErrors : public testing::TestWithParam<BadTable> {};

TEST_P(CsvReaderErrors, NamePlaceAndWhatWasFound) {
  const auto tables = parse(GetParam().text);
  ASSERT_FALSE(tables.ok());
  EXPECT_EQ(tables.error(), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    All, CsvReaderErrors,
    testing::Values(BadTable{"", "u.csv: the file is empty: a header row with 'time' and names of inputs was expected"},
                    BadTable{"\n \n", "u.csv: the file is empty: a header row with 'time' and names of inputs was expected"},
                    BadTable{"time,u[1]\n", "u.csv: the file has a header but no rows"},
                    BadTable{"t,u[1]\n0,1\n", "u.csv:1:1: there is no column 'time'; the header row is 't', 'u[1]'"},
                    BadTable{"time,t,u[1]\n0,0,1\n", "u.csv:1:6: model 'Particle' has no input 't'"},
                    BadTable{"u[1],u[2]\n0,1\n", "u.csv:1:1: there is no column 'time'; the header row is 'u[1]', 'u[2]'"},
                    BadTable{"time\n0\n", "u.csv:1:1: there is no column of an input"},
                    BadTable{"time,u[3]\n0,1\n", "u.csv:1:6: model 'Particle' has no input 'u[3]'; did you mean 'u[1]'?"},
                    BadTable{"time,q[1]\n0,1\n", "u.csv:1:6: 'q[1]' is not an input of model 'Particle'"},
                    BadTable{"time,u[1],u[1]\n0,1,1\n", "u.csv:1:11: column 'u[1]' occurs twice"},
                    BadTable{"time,u[1],u[ 1]\n0,1,1\n", "u.csv:1:11: 'u[1]' and 'u[ 1]' are the same input"},
                    BadTable{"time,u[1],time\n0,1,1\n", "u.csv:1:11: column 'time' occurs twice"},
                    BadTable{"time,,u[1]\n0,1,1\n", "u.csv:1:6: this column has no name"},
                    BadTable{"0,1\n1,2\n", "u.csv:1:1: a header row with 'time' and names of inputs was expected, found the number 0"},
                    BadTable{"time;u[1]\n0;1\n", "u.csv:1:1: fields must be separated by commas, found 'time;u[1]'"},
                    BadTable{"time,u[1]\n0,one\n", "u.csv:2:3: column 'u[1]' needs a number, found 'one'"},
                    BadTable{"time,u[1]\n0,1,2\n", "u.csv:2:5: this row has 3 fields, the header has 2"},
                    BadTable{"time,u[1]\n\n0\n", "u.csv:3:1: this row has 1 field, the header has 2"},
                    BadTable{"time,u[1]\n0,\n", "u.csv:2:3: column 'u[1]' needs a number, found nothing"},
                    BadTable{"time,u[1]\n0,1.5kg\n", "u.csv:2:3: column 'u[1]' needs a number, found '1.5kg'"},
                    BadTable{"time,u[1]\n0,nan\n", "u.csv:2:3: column 'u[1]' needs a finite number, found nan"},
                    BadTable{"time,u[1]\n0,1e999\n", "u.csv:2:3: column 'u[1]' needs a finite number, found 1e999"},
                    BadTable{"time,u[1]\n1,1\n0.5,1\n", "u.csv:3:1: times must not decrease: 0.5 comes after 1"},
                    BadTable{"time,\"u[1]\n0,1\n", "u.csv:1:6: this quoted field does not end"},
                    BadTable{"time,\"u[1]\"x\n0,1\n", "u.csv:1:12: expected a comma after the quoted field, found 'x'"},
                    BadTable{"\xFF\xFEt", "u.csv: the file is UTF-16 text; save it as UTF-8"}));

TEST(CsvReader, ReportsAFileThatIsNotThere) {
  const auto tables = readInputTables("no such folder/u.csv", ModelInstance(test::particleModel()));
  ASSERT_FALSE(tables.ok());
  EXPECT_EQ(tables.error(), "cannot read 'no such folder/u.csv': No such file or directory");
}

TEST(CsvReader, TakesVerySmallNumbersAsZero) {
  const auto tables = parse("time,u[1]\n0,1e-999\n");
  ASSERT_TRUE(tables.ok()) << tables.error();
  EXPECT_EQ(tables.value()[0].values[0], 0);
}

// Whatever the bytes are: tables whose times and values match, or a message with the file's name.
TEST(CsvReader, SurvivesRandomChanges) {
  const std::string good = "time,\"u[1]\",u[2]\r\n0,1,2\r\n0.5,\"1e3\",-2.5\r\n1,inf,4\r\n";
  const std::string pool = "0123456789.,-+e\"\r\n \t;u[]timeNa\xEF\xBB\xBF\0\xFF";
  std::mt19937 random(11);
  for (int trial = 0; trial < 5000; ++trial) {
    std::string text = good;
    for (auto change = random() % 6; change > 0; --change) {
      const std::size_t at = random() % (text.size() + 1);
      const char byte = pool[random() % pool.size()];
      if (random() % 3 == 0)
        text.insert(text.begin() + static_cast<std::ptrdiff_t>(at), byte);
      else if (random() % 2 == 0)
        text.erase(at, 1 + random() % 4);
      else if (at < text.size())
        text[at] = byte;
    }
    const auto tables = parse(text);
    if (!tables.ok()) {
      EXPECT_EQ(tables.error().substr(0, 6), "u.csv:") << text;
      continue;
    }
    for (const InputTable &table : tables.value()) {
      EXPECT_EQ(table.times.size(), table.values.size());
      EXPECT_TRUE(std::is_sorted(table.times.begin(), table.times.end()));
    }
  }
}

}  // namespace

}  // namespace tf::runtime
