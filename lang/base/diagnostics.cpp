#include "lang/base/diagnostics.h"

#include "lang/base/utf8.h"

#include <algorithm>
#include <cctype>

namespace tf {

namespace {

const char *severityName(Severity severity) {
  switch (severity) {
  case Severity::Note:
    return "note";
  case Severity::Warning:
    return "warning";
  case Severity::Error:
    return "error";
  }
  return "";
}

std::string position(Span span, const SourceManager &sources) {
  if (!span.valid() || span.file >= sources.count())
    return {};
  const SourceFile &file = sources.file(span.file);
  const auto [line, column] = file.lineColumn(span.begin);
  return fmt::format("{}:{}:{}: ", file.path(), line, column);
}

// What a terminal shows of a source line: one column per code point; tabs stay, other control characters and invalid bytes become '?'.
struct VisibleLine {
  std::string text;
  std::string underline;
};

VisibleLine visibleLine(std::string_view line, std::size_t underlineBegin, std::size_t underlineEnd) {
  VisibleLine result;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t length = decode(line.substr(i)).length;
    const bool isControl = length == 1 && std::iscntrl(static_cast<unsigned char>(line[i])) != 0 && line[i] != '\t';
    if (length == 0 || isControl)
      result.text += '?';
    else
      result.text += line.substr(i, length);
    const std::size_t next = i + std::max<std::size_t>(length, 1);
    if (next <= underlineBegin)
      result.underline += line[i] == '\t' ? '\t' : ' ';
    else if (result.underline.empty() || result.underline.back() == ' ' || result.underline.back() == '\t')
      result.underline += '^';
    else if (i < underlineEnd)
      result.underline += '~';
    i = next;
  }
  if (underlineBegin >= line.size())
    result.underline += '^';
  return result;
}

// The first line of the span and its underline; of very long lines the part around the span.
std::string excerpt(Span span, const SourceManager &sources) {
  constexpr std::size_t longLine = 240;
  constexpr std::size_t context = 80;
  if (!span.valid() || span.file >= sources.count())
    return {};
  const SourceFile &file = sources.file(span.file);
  std::string_view line = file.lineText(file.lineColumn(span.begin).line);
  const auto lineBegin = static_cast<std::size_t>(line.data() - file.text().data());
  std::size_t begin = std::min<std::size_t>(span.begin - std::min<std::size_t>(lineBegin, span.begin), line.size());
  std::size_t end = std::clamp<std::size_t>(span.end - std::min<std::size_t>(lineBegin, span.end), begin, line.size());
  if (line.size() > longLine) {
    const std::size_t from = begin > context ? begin - context : 0;
    line = line.substr(from, longLine);
    begin -= from;
    end = std::min(end - from, line.size());
  }
  const auto [text, underline] = visibleLine(line, begin, end);
  return text + "\n" + underline + "\n";
}

// Twice the optimal-string-alignment distance (insertion, deletion, substitution, transposition of neighbours); a change of case costs
// half.
int doubledDistance(std::string_view a, std::string_view b) {
  constexpr int edit = 2;
  std::vector<int> beforePrevious(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    previous[j] = edit * static_cast<int>(j);
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = edit * static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitution = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? edit / 2 : edit;
      current[j] = std::min({previous[j] + edit, current[j - 1] + edit, previous[j - 1] + substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        current[j] = std::min(current[j], beforePrevious[j - 2] + edit);
    }
    std::swap(beforePrevious, previous);
    std::swap(previous, current);
  }
  return previous[b.size()];
}

bool equalButForCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace

Diagnostic &Diagnostic::note(Span where, std::string text) {
  notes.push_back({where, std::move(text)});
  return *this;
}

Diagnostic &Diagnostic::suggest(std::string_view written, std::span<const std::string> candidates) {
  if (const std::string candidate = nearest(written, candidates); !candidate.empty())
    message += fmt::format("; did you mean '{}'?", candidate);
  return *this;
}

Diagnostic &Diagnostics::add(Diagnostic diagnostic) {
  const bool isNew = diagnostic.span.valid()
                         ? reported_.emplace(diagnostic.kind, diagnostic.span.file, diagnostic.span.begin, diagnostic.span.end).second
                         : std::none_of(all_.begin(), all_.end(), [&](const Diagnostic &other) {
                             return other.kind == diagnostic.kind && !other.span.valid() && other.message == diagnostic.message;
                           });
  if (!isNew) {
    duplicate_ = std::move(diagnostic);
    return duplicate_;
  }
  if (diagnostic.kind->severity == Severity::Error)
    ++errors_;
  return all_.emplace_back(std::move(diagnostic));
}

std::string render(const Diagnostic &diagnostic, const SourceManager &sources) {
  std::string text = fmt::format("{}{}: {}  [{}]\n", position(diagnostic.span, sources), severityName(diagnostic.kind->severity),
                                 diagnostic.message, diagnostic.kind->code);
  text += excerpt(diagnostic.span, sources);
  for (const DiagnosticNote &note : diagnostic.notes)
    text += fmt::format("{}note: {}\n", position(note.span, sources), note.message);
  return text;
}

std::string render(const Diagnostics &diagnostics, const SourceManager &sources) {
  std::string text;
  for (const Diagnostic &diagnostic : diagnostics.all())
    text += render(diagnostic, sources);
  return text;
}

std::string nearest(std::string_view name, std::span<const std::string> candidates) {
  // Up to a third of the characters may differ, but not all of them.
  const int limit = std::min(2 * std::max(1, static_cast<int>(name.size()) / 3), 2 * static_cast<int>(name.size()) - 1);
  int best = limit + 1;
  std::string result;
  for (const std::string &candidate : candidates) {
    const auto difference = static_cast<std::ptrdiff_t>(candidate.size()) - static_cast<std::ptrdiff_t>(name.size());
    if (2 * std::abs(difference) > limit || candidate == name)
      continue;
    const int distance = equalButForCase(name, candidate) ? 1 : doubledDistance(name, candidate);
    if (distance < best) {
      best = distance;
      result = candidate;
    }
  }
  return result;
}

}  // namespace tf
