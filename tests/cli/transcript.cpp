#include "tests/cli/transcript.h"
#include "tests/support/process.h"

#include <fmt/format.h>

#include <regex>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace tf::test {

namespace {

std::vector<std::string> words(const std::string &command) {
  std::vector<std::string> result;
  bool isQuoted = false, isWord = false;
  for (const char c : command) {
    if (c == '\'') {
      isQuoted = !isQuoted;
      if (!isWord)
        result.emplace_back();
      isWord = true;
    } else if (c == ' ' && !isQuoted) {
      isWord = false;
    } else {
      if (!isWord)
        result.emplace_back();
      isWord = true;
      result.back() += c;
    }
  }
  return result;
}

void replaceAll(std::string &text, const std::string &from, const std::string &to) {
  for (std::size_t i = text.find(from); i != std::string::npos; i = text.find(from, i + to.size()))
    text.replace(i, from.size(), to);
}

}  // namespace

Transcript readTranscript(const std::filesystem::path &path) {
  Transcript result;
  std::istringstream lines(readFile(path));
  std::string before;
  bool isAnswer = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("$ ")) {
      // The answer of the one before may be still to be recorded.
      if (isAnswer)
        before = "\n";
      result.entries.push_back({std::exchange(before, {}), line.substr(2), {}});
      isAnswer = true;
    } else if (isAnswer) {
      result.entries.back().answer += line + "\n";
      isAnswer = !line.starts_with("[exit ");
    } else {
      before += line + "\n";
    }
  }
  result.after = before;
  return result;
}

std::string print(const Transcript &transcript) {
  std::string text;
  for (const TranscriptEntry &entry : transcript.entries)
    text += entry.before + "$ " + entry.command + "\n" + entry.answer;
  return text + transcript.after;
}

std::string answer(const std::string &command, const std::filesystem::path &folder) {
  std::vector<std::string> arguments = words(command);
  if (arguments.empty() || arguments.front() != "tfc")
    throw std::runtime_error("a transcript's commands begin with tfc");
  arguments.erase(arguments.begin());
  const ProcessResult result = runTfc(arguments, folder);
  std::string text = result.out + result.err;
  replaceAll(text, TF_BINARY_DIR, "BUILD");
  replaceAll(text, TF_SOURCE_DIR, "SOURCE");
  text = std::regex_replace(text, std::regex("[0-9.e+-]+ ms"), "N ms");
  if (!text.empty() && text.back() != '\n')
    text += "\n";
  return fmt::format("{}[exit {}]\n", text, result.exitCode);
}

}  // namespace tf::test
