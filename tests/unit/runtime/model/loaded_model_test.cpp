#include "runtime/model/loaded_model.h"

#include "tests/unit/runtime/hand_written_models.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <ostream>
#include <sstream>
#include <vector>

namespace tf::runtime {

namespace {

using testing::HasSubstr;

std::string sample(const std::string &name) { return std::string(SAMPLE_FOLDER) + "/sample_" + name + ".so"; }

// The reason why a file is not loaded, without the beginning that names the file.
std::string reason(const std::string &path) {
  const auto loaded = LoadedModel::open(path);
  if (loaded.ok())
    return "";
  const std::string beginning = "cannot load '" + path + "': ";
  EXPECT_EQ(loaded.error().substr(0, beginning.size()), beginning);
  return loaded.error().substr(std::min(beginning.size(), loaded.error().size()));
}

std::string bytesOf(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class Loading : public testing::Test {
protected:
  Loading() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tf_model_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~Loading() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string file(const std::string &bytes) {
    const std::string path = (folder_ / ("file" + std::to_string(++count_) + ".so")).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  [[nodiscard]] std::string folder() const { return folder_.string(); }

private:
  std::filesystem::path folder_;
  int count_ = 0;
};

TEST_F(Loading, GivesTheModelOfAGoodFile) {
  const auto loaded = LoadedModel::open(sample("good"));
  ASSERT_TRUE(loaded.ok()) << loaded.error();
  EXPECT_STREQ(loaded.value().model().name, "Sample");
  EXPECT_EQ(loaded.value().model().parameters[0], 2);
}

TEST_F(Loading, RefusesOtherFiles) {
  EXPECT_EQ(reason(folder() + "/missing.so"), "No such file or directory");
  EXPECT_EQ(reason(folder()), "it is a directory");
  EXPECT_EQ(reason(file("")), "it is not a shared library");
  EXPECT_EQ(reason(file("model Particle\nend Particle;\n")), "it is not a shared library");
  EXPECT_EQ(reason(sample("other")), "it is a shared library, but not a compiled model");
  EXPECT_EQ(reason(sample("next_symbol")), "it was compiled for another version of the interface of compiled models; compile it again");
  EXPECT_EQ(reason(sample("newer")),
            fmt::format(
                "the model was compiled for version {} of the interface of compiled models, this program has version {}; compile it again",
                TF_ABI_VERSION + 1, TF_ABI_VERSION));
  EXPECT_EQ(reason(sample("unmarked")), "not a compiled model: its table does not begin with the mark of one");
  EXPECT_EQ(reason(sample("incomplete")), "the compiled model is damaged: a function is missing");
}

// Every beginning of the file is refused, none crashes.
TEST_F(Loading, RefusesTruncatedFiles) {
  const std::string whole = bytesOf(sample("good"));
  ASSERT_GT(whole.size(), 5000u);
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 8)
    EXPECT_THAT(reason(file(whole.substr(0, size))), size < 4 ? HasSubstr("not a shared library") : HasSubstr("the file is incomplete"))
        << size;
  EXPECT_EQ(reason(file(whole)), "");
}

TEST_F(Loading, RefusesOtherMachinesAndOtherKindsOfFile) {
  std::string bytes = bytesOf(sample("good"));
  bytes[18] = 2;  // e_machine: SPARC
  bytes[19] = 0;
  EXPECT_EQ(reason(file(bytes)), "it was compiled for another kind of machine");
  bytes = bytesOf(sample("good"));
  bytes[16] = 1;  // e_type: ET_REL
  EXPECT_EQ(reason(file(bytes)), "it is an object file, not a shared library");
}

struct Defect {
  const char *message;
  std::function<void(tf_model &)> make;
};

void PrintTo(const Defect &one, std::ostream *stream) { *stream << one.message; }

class DamagedTable : public testing::TestWithParam<Defect> {};

TEST_P(DamagedTable, IsRefused) {
  tf_model model = test::boxModel();
  ASSERT_TRUE(checkModel(model).ok());
  GetParam().make(model);
  EXPECT_EQ(checkModel(model).error(), std::string("the compiled model is damaged: ") + GetParam().message);
}

// A copy of a table with one entry changed; kept for the rest of the program.
template <class T> const T *changed(const T *table, std::int32_t count, const std::function<void(std::vector<T> &)> &change) {
  auto *copy = new std::vector<T>(table, table + count);
  change(*copy);
  static std::vector<std::unique_ptr<std::vector<T>>> kept;
  kept.emplace_back(copy);
  return copy->data();
}

std::function<void(tf_model &)> inVariables(std::function<void(std::vector<tf_variable> &)> change) {
  return [change](tf_model &model) { model.variables = changed<tf_variable>(model.variables, model.variable_count, change); };
}

std::function<void(tf_model &)> inContacts(std::function<void(std::vector<tf_contact> &)> change) {
  return [change](tf_model &model) { model.contacts = changed<tf_contact>(model.contacts, model.nc, change); };
}

INSTANTIATE_TEST_SUITE_P(
    All, DamagedTable,
    testing::Values(Defect{"-1 states", [](tf_model &model) { model.nz = -1; }},
                    Defect{"no table of parameters", [](tf_model &model) { model.parameters = nullptr; }},
                    Defect{"no table of switches", [](tf_model &model) { model.ns = 1; }},
                    Defect{"binding depth -2", [](tf_model &model) { model.binding_depth = -2; }},
                    Defect{"no name", [](tf_model &model) { model.name = nullptr; }},
                    Defect{"a function is missing", [](tf_model &model) { model.energies = nullptr; }},
                    Defect{"4 coordinates and 3 velocities with 0 rotations", [](tf_model &model) { model.nq = 4; }},
                    Defect{"the kinematic function is missing",
                           [](tf_model &model) {
                             static constexpr std::int32_t kFirst = 0;
                             model.nq = 4;
                             model.nr = 1;
                             model.quaternions = &kFirst;
                           }},
                    Defect{"no table of constraints", [](tf_model &model) { model.nk = 1; }},
                    Defect{"the function of the constraints is missing", [](tf_model &model) { model.nh = 1; }},
                    Defect{"its variables do not begin with time and numerical time", [](tf_model &model) { model.variable_count = 1; }},
                    Defect{"its variables do not begin with time and numerical time", inVariables([](auto &v) { std::swap(v[0], v[2]); })},
                    Defect{"variable 3 has no name", inVariables([](auto &v) { v[3].name = nullptr; })},
                    Defect{"variable 'y' is number 3 of kind 2", inVariables([](auto &v) { v[3].index = 3; })},
                    Defect{"variable 'y' is number 0 of kind 99", inVariables([](auto &v) {
                             v[3].index = 0;
                             v[3].kind = 99;
                           })},
                    Defect{"'corner[2]' has 1 tangential rows from row 3", inContacts([](auto &c) { c[1].tangent_first = 3; })},
                    Defect{"'corner[1]' has 3 tangential rows from row 0", inContacts([](auto &c) { c[0].tangent_count = 3; })},
                    Defect{"'corner[4]' has the impact law 7", inContacts([](auto &c) { c[3].law = 7; })},
                    Defect{"the structure of its mass matrix does not begin at 0",
                           [](tf_model &model) {
                             static constexpr std::int32_t kRows[] = {1, 1, 1, 1};
                             model.mass_rows = kRows;
                           }},
                    Defect{"row 1 of its mass matrix has 2 entries",
                           [](tf_model &model) {
                             static constexpr std::int32_t kRows[] = {0, 0, 2, 2}, kColumns[] = {0, 0};
                             model.mass_rows = kRows;
                             model.mass_columns = kColumns;
                           }},
                    Defect{"row 2 of its mass matrix has an entry in column 2",
                           [](tf_model &model) {
                             static constexpr std::int32_t kRows[] = {0, 0, 0, 1}, kColumns[] = {2};
                             model.mass_rows = kRows;
                             model.mass_columns = kColumns;
                           }},
                    Defect{"5 tangential rows, but its elements have 4", [](tf_model &model) { model.nt = 5; }}));

TEST(DamagedAliases, AreRefused) {
  tf_model model = test::particleModel();
  model.aliases = changed<tf_alias>(model.aliases, model.alias_count, [](auto &aliases) { aliases[1].variable = 400; });
  EXPECT_EQ(checkModel(model).error(), "the compiled model is damaged: alias 'vy' is 1 times variable 400");
}

}  // namespace

}  // namespace tf::runtime
