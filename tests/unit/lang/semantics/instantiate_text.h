// Instantiates models given as text, for tests.
#pragma once

#include "lang/semantics/instantiate.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace tf::test {

// A folder for the files of one test, removed at its end.
class Workspace {
public:
  Workspace() {
    static int count = 0;
    folder_ = std::filesystem::temp_directory_path() / ("tf_semantics_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(folder_);
  }
  ~Workspace() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  Workspace(const Workspace &) = delete;
  Workspace &operator=(const Workspace &) = delete;

  std::string write(const std::string &name, const std::string &text) const {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
    return path.string();
  }
  [[nodiscard]] std::string path() const { return folder_.string(); }

private:
  std::filesystem::path folder_;
};

struct Outcome {
  SourceManager sources;
  Diagnostics diagnostics;
  Instantiation instantiation;

  // All diagnostics as the user sees them, without the workspace's path.
  [[nodiscard]] std::string rendered(const Workspace &workspace) const {
    std::string text = render(diagnostics, sources);
    const std::string prefix = workspace.path() + "/";
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix, at))
      text.erase(at, prefix.size());
    return text;
  }
  // "TF0201 at 4:13", in order.
  [[nodiscard]] std::vector<std::string> positions() const {
    std::vector<std::string> result;
    for (const Diagnostic &diagnostic : diagnostics.all()) {
      const LineColumn at = sources.file(std::max(diagnostic.span.file, 0)).lineColumn(diagnostic.span.begin);
      result.push_back(std::string(diagnostic.kind->code) + " at " + std::to_string(at.line) + ":" + std::to_string(at.column));
    }
    return result;
  }
  [[nodiscard]] std::string flat() const { return instantiation.model ? flat::print(*instantiation.model) : std::string(); }
};

inline void instantiateFiles(Outcome &outcome, const std::vector<std::string> &files, const std::string &model = "",
                             const std::map<std::string, double> &overrides = {}) {
  InstantiateOptions options;
  options.model = model;
  options.libraries = {std::string(TF_SOURCE_DIR) + "/stdlib"};
  options.structuralOverrides = overrides;
  outcome.instantiation = instantiate(outcome.sources, files, options, outcome.diagnostics);
}

inline void instantiateText(Outcome &outcome, const Workspace &workspace, const std::string &text, const std::string &model = "",
                            const std::map<std::string, double> &overrides = {}) {
  instantiateFiles(outcome, {workspace.write("example.tf", text)}, model, overrides);
}

inline std::string readFile(const std::filesystem::path &path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// The value of the comment line `// key: value`, "" if there is none.
inline std::string headerValue(const std::string &text, const std::string &key) {
  const std::string prefix = "// " + key + ": ";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && line.starts_with("//");)
    if (line.starts_with(prefix))
      return line.substr(prefix.size());
  return {};
}

}  // namespace tf::test
