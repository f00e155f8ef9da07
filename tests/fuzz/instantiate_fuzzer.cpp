// Instantiates the input as a model file, with the standard library at hand. Beyond not crashing: there is a model exactly if there is no
// error, it passes its verifier, and messages can be rendered.
#include "lang/semantics/instantiate.h"
#include "tests/fuzz/fuzz_entry.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

// A folder of this process, removed at its end.
class Folder {
public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("tf_fuzz_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder &) = delete;
  Folder &operator=(const Folder &) = delete;
  [[nodiscard]] std::string file() const { return (path_ / "input.tf").string(); }

private:
  std::filesystem::path path_;
};

void require(bool condition, const char *what, const std::string &details) {
  if (condition)
    return;
  std::fprintf(stderr, "%s\n%s\n", what, details.c_str());
  std::abort();
}

// The names to choose from if the file has not exactly one model.
std::vector<std::string> check(const std::string &path, const std::string &model) {
  tf::SourceManager sources;
  tf::Diagnostics diagnostics;
  tf::InstantiateOptions options;
  options.model = model;
  options.libraries = {TF_SOURCE_DIR "/stdlib"};
  const tf::Instantiation result = tf::instantiate(sources, {path}, options, diagnostics);
  const std::string rendered = tf::render(diagnostics, sources);
  if (!result.model.has_value()) {
    require(diagnostics.hasErrors() || result.candidates.size() > 1, "no model and no error", rendered);
    return result.candidates;
  }
  require(!diagnostics.hasErrors(), "a model in spite of errors", rendered);
  const std::string printed = tf::flat::print(*result.model);
  const std::string violation = tf::flat::verify(*result.model);
  require(violation.empty(), violation.c_str(), printed);
  return {};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  static const Folder folder;
  std::ofstream(folder.file(), std::ios::binary).write(reinterpret_cast<const char *>(data), static_cast<std::streamsize>(size));
  constexpr std::size_t manyModels = 4;
  const std::vector<std::string> candidates = check(folder.file(), {});
  for (std::size_t i = 0; i < std::min(candidates.size(), manyModels); ++i)
    check(folder.file(), candidates[i]);
  return 0;
}
