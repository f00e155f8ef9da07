// Misspelled words: reported with what was probably meant, and read as that. Only where the text would not be legal as it stands.
#include "lang/syntax/parser_core.h"

namespace tf::syntax {

void Parser::replaceWord(TokenKind kind) {
  tokens_[position_].kind = kind;
  resume();
}

// Whether `["."] name [subscripts] IDENT` begins `ahead` tokens from here, on one line if so wanted.
bool Parser::typeAndNameFollow(std::size_t ahead, bool onOneLine) const {
  const std::size_t first = ahead;
  if (peek(ahead).kind == TokenKind::Dot)
    ++ahead;
  if (peek(ahead++).kind != TokenKind::Identifier)
    return false;
  while (peek(ahead).kind == TokenKind::Dot && peek(ahead + 1).kind == TokenKind::Identifier)
    ahead += 2;
  if (peek(ahead).kind == TokenKind::LeftBracket) {
    int depth = 0;
    do {
      const TokenKind kind = peek(ahead++).kind;
      if (kind == TokenKind::EndOfFile || kind == TokenKind::Semicolon)
        return false;
      depth += kind == TokenKind::LeftBracket ? 1 : kind == TokenKind::RightBracket ? -1 : 0;
    } while (depth > 0);
  }
  for (std::size_t i = first; onOneLine && i <= ahead; ++i) {
    if (peek(i).startsLine)
      return false;
  }
  return peek(ahead).kind == TokenKind::Identifier;
}

// `paramter Real x`: a word, a type and a name on one line.
void Parser::repairMisspelledPrefix() {
  static const std::vector<std::string> words = {"parameter", "coordinate", "constant", "discrete", "input", "output", "flow", "stream"};
  if (!at(TokenKind::Identifier) || peek(1).kind != TokenKind::Identifier || atCoordinatePrefix() || !typeAndNameFollow(1, true))
    return;
  const std::string meant = nearest(text(current()), words);
  if (meant.empty())
    return;
  complain(UnknownWord, span(current()), text(current()), meant);
  if (meant == "coordinate")
    assumedWord_ = position_;
  else
    replaceWord(keyword(meant));
}

// `modle M`: a word and a name, and on the next line, possibly behind a description, what does not continue a declaration.
void Parser::repairMisspelledClass() {
  static const std::vector<std::string> words = {"model", "package", "function", "record", "block", "connector", "type", "class"};
  if (!at(TokenKind::Identifier) || peek(1).kind != TokenKind::Identifier || peek(1).startsLine)
    return;
  const std::size_t ahead = peek(2).kind == TokenKind::String ? 3 : 2;
  const Token &next = peek(ahead);
  const bool beginsBody = next.startsLine && next.kind != TokenKind::Semicolon && next.kind != TokenKind::Annotation &&
                          next.kind != TokenKind::Constrainedby && next.kind != TokenKind::String &&
                          (next.kind == TokenKind::Identifier || isKeyword(next.kind));
  if (!beginsBody)
    return;
  const std::string meant = nearest(text(current()), words);
  if (meant.empty())
    return;
  complain(UnknownWord, span(current()), text(current()), meant);
  replaceWord(keyword(meant));
}

// `equations` alone on its line: a word that is nearly a section's and not followed by the rest of a declaration.
bool Parser::parseMisspelledSection(ast::ListBuilder<ast::Section> &sections, bool &isProtected) {
  static const std::vector<std::string> common = {"equation", "algorithm", "public", "protected"};
  static const std::vector<std::string> inOptimization = {"equation", "algorithm", "public", "protected", "constraint"};
  const bool isOptimization = enclosing_ == ast::Restriction::Optimization;
  const Token &token = current();
  const Token &next = peek(1);
  if (!at(TokenKind::Identifier) || !token.startsLine)
    return false;
  if (!next.startsLine && (next.kind == TokenKind::Equation || next.kind == TokenKind::Algorithm)) {
    const std::string written = fmt::format("{} {}", text(token), text(next));
    complain(UnknownSection, cover(span(token), span(next)), written, fmt::format("initial {}", text(next)));
    replaceWord(TokenKind::Initial);
    sections.push(parseSection());
    return true;
  }
  if (!next.startsLine)
    return false;
  const std::string meant = nearest(text(token), isOptimization ? inOptimization : common);
  if (meant.empty() || next.kind == TokenKind::Dot)
    return false;
  const bool isSection = meant != "public" && meant != "protected";
  const TokenKind afterNext = peek(2).kind;
  const bool continuesEquation = afterNext == TokenKind::Equal || afterNext == TokenKind::Assign || afterNext == TokenKind::Dot ||
                                 afterNext == TokenKind::Plus || afterNext == TokenKind::Minus || afterNext == TokenKind::Times ||
                                 (isOptimization && afterNext == TokenKind::LeftParenthesis) || afterNext == TokenKind::LessEqual ||
                                 afterNext == TokenKind::GreaterEqual;
  if (next.kind == TokenKind::Identifier && !(isSection ? continuesEquation : afterNext == TokenKind::Identifier))
    return false;
  complain(UnknownSection, span(token), text(token), meant);
  if (meant == "constraint")
    assumedWord_ = position_;
  else
    replaceWord(keyword(meant));
  if (isSection)
    sections.push(parseSection());
  else {
    isProtected = meant == "protected";
    advance();
  }
  return true;
}

// `elsif` and the like are read as `elseif`.
bool Parser::atMisspelledElseif() {
  if (openBlocks_.empty() || openBlocks_.back() != TokenKind::If || !(atWord("elsif") || atWord("elif") || atWord("elseIf")))
    return false;
  const TokenKind next = peek(1).kind;
  if (next == TokenKind::Equal || next == TokenKind::Assign || next == TokenKind::Dot || next == TokenKind::LeftBracket)
    return false;
  complain(UnexpectedToken, span(current()), "'elseif'", describe(current()));
  replaceWord(TokenKind::Elseif);
  return true;
}

// `endif`
bool Parser::atGluedEnd() const {
  return !openBlocks_.empty() && at(TokenKind::Identifier) && peek(1).kind == TokenKind::Semicolon && text(current()).starts_with("end") &&
         text(current()).substr(3) == spelling(openBlocks_.back());
}

}  // namespace tf::syntax
