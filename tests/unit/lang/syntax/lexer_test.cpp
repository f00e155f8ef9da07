#include "lang/syntax/lexer.h"

#include <gmock/gmock.h>

namespace tf::syntax {
namespace {

using testing::ElementsAre;

struct Lexed {
  SourceManager sources;
  Diagnostics diagnostics;
  LexedText result;

  explicit Lexed(std::string text) { result = lex(sources, sources.add("m.tf", std::move(text)), diagnostics); }

  // Spellings, without the end of the file.
  [[nodiscard]] std::vector<std::string> words() const {
    std::vector<std::string> words;
    for (const Token &token : result.tokens)
      words.emplace_back(sources.text({0, token.begin, token.end}));
    EXPECT_EQ(result.tokens.back().kind, TokenKind::EndOfFile);
    words.pop_back();
    return words;
  }
  [[nodiscard]] std::vector<TokenKind> kinds() const {
    std::vector<TokenKind> kinds;
    for (const Token &token : result.tokens)
      kinds.push_back(token.kind);
    kinds.pop_back();
    return kinds;
  }
};

TEST(Lexer, TakesTheLongestToken) {
  const Lexed lexed("a:=b==c<=d<>e>=f.+g.-h.*i./j.^k");
  EXPECT_THAT(lexed.words(), ElementsAre("a", ":=", "b", "==", "c", "<=", "d", "<>", "e", ">=", "f", ".+", "g", ".-", "h", ".*", "i", "./",
                                         "j", ".^", "k"));
}

TEST(Lexer, Numbers) {
  const Lexed lexed("1 12. .5 1.5 1e3 1E+3 2.e-1 .5e2");
  EXPECT_THAT(lexed.kinds(), ElementsAre(TokenKind::Integer, TokenKind::Real, TokenKind::Real, TokenKind::Real, TokenKind::Real,
                                         TokenKind::Real, TokenKind::Real, TokenKind::Real));
  EXPECT_FALSE(lexed.diagnostics.hasErrors());
}

TEST(Lexer, ANumberEndsBeforeAWord) {
  EXPECT_THAT(Lexed("1else").words(), ElementsAre("1", "else"));
  EXPECT_THAT(Lexed("1end").words(), ElementsAre("1", "end"));
  EXPECT_THAT(Lexed("1:2").words(), ElementsAre("1", ":", "2"));
}

TEST(Lexer, KeywordsAndNames) {
  const Lexed lexed("model Model modelx _x x1 within when 'model' coordinate");
  EXPECT_THAT(lexed.kinds(),
              ElementsAre(TokenKind::Model, TokenKind::Identifier, TokenKind::Identifier, TokenKind::Identifier, TokenKind::Identifier,
                          TokenKind::Within, TokenKind::When, TokenKind::Identifier, TokenKind::Identifier));
}

TEST(Lexer, EveryKeywordIsRecognised) {
#define TF_TOKEN(name, spelling)
#define TF_KEYWORD(name, spelling) EXPECT_EQ(keyword(spelling), TokenKind::name) << spelling;
#include "lang/syntax/tokens.def"
  for (const char *word : {"", "e", "en", "ends", "End", "modelica", "time", "constraint"})
    EXPECT_EQ(keyword(word), TokenKind::Identifier) << word;
}

TEST(Lexer, StringsMaySpanLinesAndContainEscapes) {
  const Lexed lexed("\"a\nb\" \"q\\\"q\" 'it\\'s'");
  EXPECT_THAT(lexed.words(), ElementsAre("\"a\nb\"", "\"q\\\"q\"", "'it\\'s'"));
  EXPECT_FALSE(lexed.diagnostics.hasErrors());
}

TEST(Lexer, CommentsAreKeptAside) {
  const Lexed lexed("a // one\nb /* two\n */ c /**/ //");
  EXPECT_THAT(lexed.words(), ElementsAre("a", "b", "c"));
  std::vector<std::string> comments;
  for (const Span &comment : lexed.result.comments)
    comments.emplace_back(lexed.sources.text(comment));
  EXPECT_THAT(comments, ElementsAre("// one", "/* two\n */", "/**/", "//"));
}

TEST(Lexer, FirstTokensOfLinesAreMarked) {
  const Lexed lexed("a b\nc /*\n*/ d\r\n// x\r\ne");
  std::vector<bool> starts;
  for (const Token &token : lexed.result.tokens)
    starts.push_back(token.startsLine);
  EXPECT_THAT(starts, ElementsAre(true, false, true, true, true, false));
}

TEST(Lexer, AByteOrderMarkIsSkipped) {
  const Lexed lexed("\xEF\xBB\xBFmodel");
  EXPECT_THAT(lexed.kinds(), ElementsAre(TokenKind::Model));
  EXPECT_FALSE(lexed.diagnostics.hasErrors());
}

TEST(Lexer, UnicodeIsFreeInStringsAndComments) {
  EXPECT_FALSE(Lexed("\"\xC3\xA9 \xE2\x82\xAC\" // \xF0\x9F\x98\x80\n/* \xC3\xA9 */").diagnostics.hasErrors());
}

TEST(Lexer, ErrorsLeaveATokenSequence) {
  EXPECT_THAT(Lexed("a != b && !c").words(), ElementsAre("a", "!=", "b", "&&", "!", "c"));
  EXPECT_THAT(Lexed("gr\xC3\xB6\xC3\x9F"
                    "e = 1")
                  .words(),
              ElementsAre("gr\xC3\xB6\xC3\x9F"
                          "e",
                          "=", "1"));
  EXPECT_THAT(Lexed("x $ y").words(), ElementsAre("x", "y"));
  EXPECT_THAT(Lexed("'x = 1;\ny").words(), ElementsAre("'x", "=", "1", ";", "y"));
}

TEST(Lexer, AfterAnUnterminatedStringNothingIsReliable) {
  const Lexed lexed("a \"b\nc");
  EXPECT_EQ(lexed.result.unreliableFrom, 2U);
  EXPECT_EQ(lexed.diagnostics.errorCount(), 1);
}

TEST(Lexer, AFileThatIsNoTextIsGivenUpSoon) {
  std::string text;
  for (int i = 0; i < 1000; ++i)
    text += "\xFF x ";
  EXPECT_EQ(Lexed(text).diagnostics.errorCount(), 10);
}

}  // namespace
}  // namespace tf::syntax
