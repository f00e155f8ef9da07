// Every transcript below tests/: the answers must be the recorded ones. `transcript_test --update` records them anew.
#include "tests/cli/transcript.h"
#include "tests/support/process.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <set>

namespace tf::test {
namespace {

namespace fs = std::filesystem;

// Folders of transcripts (*.txt), whose commands run in them.
std::vector<fs::path> transcriptFiles() {
  std::vector<fs::path> files;
  for (const char *folder : {"tests/cli/bad_input", "tests/cli/good_input", "tests/golden"}) {
    const fs::path path = fs::path(TF_SOURCE_DIR) / folder;
    if (!fs::exists(path))
      continue;
    for (const auto &entry : fs::directory_iterator(path)) {
      if (entry.path().extension() == ".txt")
        files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct Recorded {
  fs::path file;
  TranscriptEntry entry;
  std::string name;
};

void PrintTo(const Recorded &recorded, std::ostream *stream) { *stream << recorded.entry.command; }

std::vector<Recorded> allEntries() {
  std::vector<Recorded> all;
  for (const fs::path &file : transcriptFiles()) {
    int number = 0;
    for (const TranscriptEntry &entry : readTranscript(file).entries) {
      std::string name = file.parent_path().filename().string() + "_" + file.stem().string() + "_" + std::to_string(++number);
      std::replace_if(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
      all.push_back({file, entry, name});
    }
  }
  return all;
}

std::string entryName(const testing::TestParamInfo<Recorded> &info) { return info.param.name; }

class Transcripts : public testing::TestWithParam<Recorded> {};

TEST_P(Transcripts, AnswersAsRecorded) {
  const Recorded &recorded = GetParam();
  EXPECT_EQ(answer(recorded.entry.command, recorded.file.parent_path()), recorded.entry.answer) << "$ " << recorded.entry.command;
}

INSTANTIATE_TEST_SUITE_P(All, Transcripts, testing::ValuesIn(allEntries()), entryName);

TEST(BadInput, HasAtLeastSixtyCases) {
  std::set<std::string> commands;
  for (const Recorded &recorded : allEntries()) {
    if (recorded.file.parent_path().filename() == "bad_input" && recorded.entry.answer.find("[exit 0]") == std::string::npos)
      commands.insert(recorded.entry.command);
  }
  EXPECT_GE(commands.size(), 60U);
}

TEST(BadInput, NeverIsAnInternalError) {
  for (const Recorded &recorded : allEntries()) {
    EXPECT_EQ(recorded.entry.answer.find("internal error"), std::string::npos) << recorded.entry.command;
    const int exitCode = std::stoi(recorded.entry.answer.substr(recorded.entry.answer.rfind("[exit ") + 6));
    EXPECT_LE(exitCode, 3) << recorded.entry.command;
  }
}

void update() {
  for (const fs::path &file : transcriptFiles()) {
    Transcript transcript = readTranscript(file);
    for (TranscriptEntry &entry : transcript.entries)
      entry.answer = answer(entry.command, file.parent_path());
    if (const std::string text = print(transcript); text != readFile(file)) {
      writeFile(file, text);
      std::cout << "updated " << fs::relative(file, TF_SOURCE_DIR).string() << "\n";
    }
  }
}

}  // namespace
}  // namespace tf::test

int main(int argc, char **argv) {
  if (argc > 1 && std::string(argv[1]) == "--update") {
    tf::test::update();
    return 0;
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
