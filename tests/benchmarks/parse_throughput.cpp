// Parses every .mo and .tf file below the given paths and prints the throughput: parse_throughput PATH… ; diagnostics go to stderr.
#include "lang/syntax/parser.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

namespace {

std::vector<std::string> collect(int argc, char **argv) {
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (!std::filesystem::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto &entry : std::filesystem::recursive_directory_iterator(argv[i])) {
      const auto extension = entry.path().extension();
      if (entry.is_regular_file() && (extension == ".mo" || extension == ".tf"))
        files.push_back(entry.path().string());
    }
  }
  return files;
}

}  // namespace

int main(int argc, char **argv) {
  tf::SourceManager sources;
  std::size_t bytes = 0;
  for (const std::string &path : collect(argc, argv)) {
    if (const auto file = sources.load(path))
      bytes += sources.file(*file).text().size();
    else
      fmt::print(stderr, "{}: cannot be read\n", path);
  }
  tf::Diagnostics diagnostics;
  const auto start = std::chrono::steady_clock::now();
  for (tf::FileId file = 0; file < sources.count(); ++file)
    (void)tf::ast::parseFile(sources, file, diagnostics);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  fmt::print(stderr, "{}", tf::render(diagnostics, sources));
  fmt::print("{} files, {:.2f} MB, {} errors, {:.3f} s, {:.1f} MB/s\n", sources.count(), static_cast<double>(bytes) * 1e-6,
             diagnostics.errorCount(), seconds.count(), static_cast<double>(bytes) * 1e-6 / seconds.count());
  return diagnostics.hasErrors() ? 1 : 0;
}
