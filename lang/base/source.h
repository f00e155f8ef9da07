// Source files and spans. A span is a half-open byte range of one file; every node of every later form carries one.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tf {

using FileId = std::int32_t;

struct Span {
  FileId file = -1;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  [[nodiscard]] bool valid() const { return file >= 0; }
  bool operator==(const Span &) const = default;
};

// The smallest span that contains both; an invalid one is neutral.
[[nodiscard]] Span cover(Span a, Span b);

struct LineColumn {
  int line = 1;    // from 1
  int column = 1;  // from 1, in UTF-8 code points
};

class SourceFile {
public:
  SourceFile(std::string path, std::string text);

  [[nodiscard]] const std::string &path() const { return path_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] LineColumn lineColumn(std::uint32_t offset) const;
  // Line `line` (from 1) without its line break.
  [[nodiscard]] std::string_view lineText(int line) const;

private:
  std::string path_;
  std::string text_;
  std::vector<std::uint32_t> lineStarts_;
};

// Owns every text that was read; addresses of texts are stable for the manager's lifetime.
class SourceManager {
public:
  FileId add(std::string path, std::string text);
  // Reads a file; nothing if it cannot be read.
  std::optional<FileId> load(const std::string &path);
  [[nodiscard]] const SourceFile &file(FileId id) const { return files_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] std::string_view text(Span span) const;
  [[nodiscard]] int count() const { return static_cast<int>(files_.size()); }

private:
  std::deque<SourceFile> files_;
};

}  // namespace tf
