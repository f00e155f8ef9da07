#include "lang/base/source.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

namespace tf {

namespace {

bool isContinuationByte(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

}  // namespace

Span cover(Span a, Span b) {
  if (!a.valid())
    return b;
  if (!b.valid() || a.file != b.file)
    return a;
  return {a.file, std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

SourceFile::SourceFile(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {
  lineStarts_.push_back(0);
  // A line ends with "\n", "\r\n" or "\r".
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] == '\n' || (text_[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n')))
      lineStarts_.push_back(static_cast<std::uint32_t>(i + 1));
  }
}

LineColumn SourceFile::lineColumn(std::uint32_t offset) const {
  const auto position = std::min(static_cast<std::size_t>(offset), text_.size());
  const auto next = std::upper_bound(lineStarts_.begin(), lineStarts_.end(), static_cast<std::uint32_t>(position));
  const auto start = static_cast<std::ptrdiff_t>(*std::prev(next));
  const auto bytesBefore = static_cast<std::ptrdiff_t>(position) - start;
  const auto continuation = std::count_if(text_.begin() + start, text_.begin() + start + bytesBefore, isContinuationByte);
  return {static_cast<int>(next - lineStarts_.begin()), static_cast<int>(bytesBefore - continuation) + 1};
}

std::string_view SourceFile::lineText(int line) const {
  if (line < 1 || static_cast<std::size_t>(line) > lineStarts_.size())
    return {};
  const auto index = static_cast<std::size_t>(line) - 1;
  const std::size_t begin = lineStarts_[index];
  std::size_t end = index + 1 < lineStarts_.size() ? lineStarts_[index + 1] : text_.size();
  while (end > begin && (text_[end - 1] == '\n' || text_[end - 1] == '\r'))
    --end;
  return text().substr(begin, end - begin);
}

FileId SourceManager::add(std::string path, std::string text) {
  files_.emplace_back(std::move(path), std::move(text));
  return static_cast<FileId>(files_.size()) - 1;
}

std::optional<FileId> SourceManager::load(const std::string &path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return std::nullopt;
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    return std::nullopt;
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  // Spans have 32-bit offsets.
  if (stream.bad() || text.size() >= std::numeric_limits<std::uint32_t>::max())
    return std::nullopt;
  return add(path, std::move(text));
}

std::string_view SourceManager::text(Span span) const {
  if (!span.valid() || span.file >= count())
    return {};
  const std::string_view whole = file(span.file).text();
  const std::size_t begin = std::min<std::size_t>(span.begin, whole.size());
  const std::size_t end = std::clamp<std::size_t>(span.end, begin, whole.size());
  return whole.substr(begin, end - begin);
}

}  // namespace tf
