#include "lang/base/diagnostics.h"

#include <gtest/gtest.h>

namespace tf {
namespace {

constexpr DiagnosticKind shape{"TF9901", Severity::Error, "Shape", "'{}' needs a scalar, got Real[{}]"};
constexpr DiagnosticKind unknown{"TF9902", Severity::Error, "Unknown", "unknown name '{}'"};
constexpr DiagnosticKind unused{"TF9903", Severity::Warning, "Unused", "'{}' is not used"};

Span find(const SourceManager &sources, std::string_view text) {
  const auto begin = static_cast<std::uint32_t>(sources.file(0).text().find(text));
  return {0, begin, begin + static_cast<std::uint32_t>(text.size())};
}

TEST(Diagnostics, AreRenderedWithSourceLineUnderlineAndNotes) {
  SourceManager sources;
  sources.add("particle.tf", "model P\n  Real q[2];\n  body b(mass = m, position = {q, q});\nend P;\n");
  Diagnostics diagnostics;
  diagnostics.report(shape, find(sources, "position = {q, q}"), "position", "2, 2").note(find(sources, "q[2]"), "'q' is declared here");
  EXPECT_EQ(render(diagnostics, sources), "particle.tf:3:20: error: 'position' needs a scalar, got Real[2, 2]  [TF9901]\n"
                                          "  body b(mass = m, position = {q, q});\n"
                                          "                   ^~~~~~~~~~~~~~~~~\n"
                                          "particle.tf:2:8: note: 'q' is declared here\n");
}

TEST(Diagnostics, WithoutASpanHaveNoPosition) {
  const SourceManager sources;
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{}, "mu");
  EXPECT_EQ(render(diagnostics, sources), "error: unknown name 'mu'  [TF9902]\n");
}

TEST(Diagnostics, UnderlineIsAlignedBehindTabsAndLettersOfSeveralBytes) {
  SourceManager sources;
  sources.add("a.tf", "\t\"\xC3\xA9\" mu\xFF\x01;");
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{0, 6, 8}, "mu");
  EXPECT_EQ(render(diagnostics, sources), "a.tf:1:6: error: unknown name 'mu'  [TF9902]\n\t\"\xC3\xA9\" mu??;\n\t    ^~\n");
}

TEST(Diagnostics, AnEmptyRangeIsOneCaret) {
  SourceManager sources;
  sources.add("a.tf", "ab\nc");
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{0, 1, 1}, "x");
  diagnostics.report(unknown, Span{0, 2, 2}, "y");
  EXPECT_EQ(render(diagnostics, sources), "a.tf:1:2: error: unknown name 'x'  [TF9902]\nab\n ^\n"
                                          "a.tf:1:3: error: unknown name 'y'  [TF9902]\nab\n  ^\n");
}

TEST(Diagnostics, ARangeOfSeveralLinesIsUnderlinedToTheEndOfItsFirst) {
  SourceManager sources;
  sources.add("a.tf", "x = (1 +\n2);");
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{0, 4, 11}, "x");
  EXPECT_EQ(render(diagnostics, sources), "a.tf:1:5: error: unknown name 'x'  [TF9902]\nx = (1 +\n    ^~~~\n");
}

TEST(Diagnostics, OfLongLinesTheNeighbourhoodIsShown) {
  SourceManager sources;
  sources.add("a.tf", std::string(5000, ' ') + "mu" + std::string(5000, ' '));
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{0, 5000, 5002}, "mu");
  const std::string text = render(diagnostics, sources);
  EXPECT_LT(text.size(), 500U);
  EXPECT_NE(text.find("a.tf:1:5001: error"), std::string::npos);
  EXPECT_NE(text.find("\n" + std::string(80, ' ') + "^~\n"), std::string::npos);
}

TEST(Diagnostics, ASecondReportAtTheSamePlaceIsDropped) {
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{0, 1, 2}, "x");
  diagnostics.report(unknown, Span{0, 1, 2}, "again").note({}, "lost");
  diagnostics.report(unknown, Span{0, 1, 3}, "longer");
  diagnostics.report(unused, Span{0, 1, 2}, "x");
  ASSERT_EQ(diagnostics.all().size(), 3U);
  EXPECT_EQ(diagnostics.errorCount(), 2);
  EXPECT_TRUE(diagnostics.all()[0].notes.empty());
}

TEST(Diagnostics, WithoutASpanOnlyTheSameMessageIsDropped) {
  Diagnostics diagnostics;
  diagnostics.report(unknown, Span{}, "x");
  diagnostics.report(unknown, Span{}, "y");
  diagnostics.report(unknown, Span{}, "x");
  EXPECT_EQ(diagnostics.all().size(), 2U);
}

TEST(Diagnostics, WarningsAreNoErrors) {
  Diagnostics diagnostics;
  diagnostics.report(unused, Span{0, 1, 2}, "x");
  EXPECT_FALSE(diagnostics.hasErrors());
  const SourceManager sources;
  EXPECT_EQ(render(diagnostics, sources), "warning: 'x' is not used  [TF9903]\n");
}

TEST(Diagnostics, SuggestNamesTheNearestCandidate) {
  Diagnostics diagnostics;
  const std::vector<std::string> candidates = {"friction", "floor"};
  EXPECT_EQ(diagnostics.report(unknown, Span{}, "flor").suggest("flor", candidates).message, "unknown name 'flor'; did you mean 'floor'?");
  EXPECT_EQ(diagnostics.report(unknown, Span{}, "wall").suggest("wall", candidates).message, "unknown name 'wall'");
}

TEST(Nearest, ToleratesOneEditInThreeCharacters) {
  const std::vector<std::string> candidates = {"restitution", "friction", "gap", "mu", "x"};
  EXPECT_EQ(nearest("resitution", candidates), "restitution");  // deletion
  EXPECT_EQ(nearest("frictiom", candidates), "friction");       // substitution
  EXPECT_EQ(nearest("firction", candidates), "friction");       // transposition
  EXPECT_EQ(nearest("gapp", candidates), "gap");                // insertion
  EXPECT_EQ(nearest("Gap", candidates), "gap");                 // case
  EXPECT_EQ(nearest("FRICTION", candidates), "friction");
  EXPECT_EQ(nearest("position", candidates), "");
}

TEST(Nearest, OfOneLetterOnlyTheCaseMayDiffer) {
  const std::vector<std::string> candidates = {"x"};
  EXPECT_EQ(nearest("X", candidates), "x");
  EXPECT_EQ(nearest("y", candidates), "");
  EXPECT_EQ(nearest("", candidates), "");
}

TEST(Nearest, TakesTheBetterOfTwo) {
  const std::vector<std::string> candidates = {"velocities", "velocity"};
  EXPECT_EQ(nearest("velocityy", candidates), "velocity");
}

}  // namespace
}  // namespace tf
