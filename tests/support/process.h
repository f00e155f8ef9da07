// Programs as tests run them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tf::test {

struct ProcessResult {
  int exitCode = -1;  // 128 + signal where it was ended by one
  std::string out, err;
};

// Runs a program (a path) with arguments in a folder and waits for its end. `environment` entries "NAME=value" replace inherited ones.
// Throws std::runtime_error if it cannot be started.
[[nodiscard]] ProcessResult runProcess(const std::filesystem::path &program, const std::vector<std::string> &arguments,
                                       const std::filesystem::path &folder, const std::vector<std::string> &environment = {});

// The program under test, with a cache of its own below the build folder.
[[nodiscard]] ProcessResult runTfc(const std::vector<std::string> &arguments, const std::filesystem::path &folder);

// The number in the line "NAME = NUMBER unit" that `tfc run` prints; NaN if there is none.
[[nodiscard]] double finalValue(const ProcessResult &result, const std::string &name);

// A new empty folder; removed with the object.
class TemporaryFolder {
public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &operator=(const TemporaryFolder &) = delete;
  [[nodiscard]] const std::filesystem::path &path() const { return path_; }

private:
  std::filesystem::path path_;
};

[[nodiscard]] std::string readFile(const std::filesystem::path &path);
void writeFile(const std::filesystem::path &path, const std::string &text);

}  // namespace tf::test
