// Diagnostics as data: a registered kind, the narrowest span, the message, notes, and a suggestion where one is near.
// Each phase registers its kinds in a `diagnostics.def` beside its code with TF_DIAGNOSTIC(name, code, severity, format); codes:
// TF01xx syntax, TF02xx names and modification, TF03xx mechanical elements, TF04xx types, arrays and units, TF05xx equations,
// TF06xx start and structure of the derived system, TF07xx code generation, TF08xx command line and files, TF09xx run.
#pragma once

#include "lang/base/source.h"

#include <fmt/format.h>

#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tf {

enum class Severity : std::uint8_t { Note, Warning, Error };

struct DiagnosticKind {
  const char *code;  // "TF0312"; never reused
  Severity severity;
  const char *name;    // the identifier it is registered under
  const char *format;  // fmt format string
};

struct DiagnosticNote {
  Span span;
  std::string message;
};

struct Diagnostic {
  const DiagnosticKind *kind = nullptr;
  Span span;
  std::string message;
  std::vector<DiagnosticNote> notes;

  Diagnostic &note(Span where, std::string text);
  // Appends "; did you mean 'x'?" to the message when a candidate is near what the user wrote.
  Diagnostic &suggest(std::string_view written, std::span<const std::string> candidates);
};

class Diagnostics {
public:
  template <class... Args> Diagnostic &report(const DiagnosticKind &kind, Span span, const Args &...args) {
    return add(Diagnostic{&kind, span, fmt::format(fmt::runtime(kind.format), args...), {}});
  }

  [[nodiscard]] bool hasErrors() const { return errors_ > 0; }
  [[nodiscard]] int errorCount() const { return errors_; }
  // In order of report; a second report of the same kind at the same span is dropped (without a span: one with the same message).
  [[nodiscard]] const std::deque<Diagnostic> &all() const { return all_; }

  // A diagnostic that was made elsewhere.
  Diagnostic &add(Diagnostic diagnostic);

private:
  std::deque<Diagnostic> all_;
  std::set<std::tuple<const DiagnosticKind *, FileId, std::uint32_t, std::uint32_t>> reported_;
  Diagnostic duplicate_;  // what notes to a dropped report go to
  int errors_ = 0;
};

// The form of language.md section 6: "file:line:col: error: message  [code]", the source line, the underline, the notes.
[[nodiscard]] std::string render(const Diagnostic &diagnostic, const SourceManager &sources);
[[nodiscard]] std::string render(const Diagnostics &diagnostics, const SourceManager &sources);

// The candidate nearest to `name` by edit distance, empty if none is near enough to be a misspelling.
[[nodiscard]] std::string nearest(std::string_view name, std::span<const std::string> candidates);

}  // namespace tf
