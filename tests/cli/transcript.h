// Transcripts: what a user types and exactly what the program answers.
//
//     # comment
//     $ tfc run no_such.tf 'second argument'
//     error: cannot read 'no_such.tf': No such file or directory  [TF0820]
//     [exit 2]
//
// The answer is the standard output followed by the standard error. Arguments are separated by blanks; single quotes keep them together.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tf::test {

struct TranscriptEntry {
  std::string before;   // comments and blank lines above it
  std::string command;  // after "$ "
  std::string answer;   // with the line "[exit N]"
};

struct Transcript {
  std::vector<TranscriptEntry> entries;
  std::string after;
};

[[nodiscard]] Transcript readTranscript(const std::filesystem::path &path);
[[nodiscard]] std::string print(const Transcript &transcript);

// Runs the command in the folder. Paths of the build and source folders appear as BUILD and SOURCE, CPU times as N ms.
[[nodiscard]] std::string answer(const std::string &command, const std::filesystem::path &folder);

}  // namespace tf::test
