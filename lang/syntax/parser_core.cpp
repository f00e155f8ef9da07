// Tokens, errors and recovery of the parser.
#include "lang/syntax/parser_core.h"

#include "lang/base/utf8.h"

namespace tf::syntax {

Parser::Parser(const SourceManager &sources, FileId file, ast::Arena &arena, Diagnostics &diagnostics)
    : file_(file), source_(sources.file(file).text()), arena_(arena), diagnostics_(diagnostics) {
  LexedText lexed = lex(sources, file, diagnostics);
  tokens_ = std::move(lexed.tokens);
  comments_ = std::move(lexed.comments);
  unreliableFrom_ = lexed.unreliableFrom;
  kind_ = tokens_.front().kind;
}

void Parser::advance() {
  if (position_ + 1 < tokens_.size())
    ++position_;
  kind_ = tokens_[position_].kind;
}

bool Parser::accept(TokenKind kind) {
  if (!at(kind))
    return false;
  advance();
  return true;
}

void Parser::rewind(std::size_t position) {
  position_ = position;
  kind_ = tokens_[position_].kind;
}

void Parser::resume() {
  recovering_ = false;
  kind_ = tokens_[position_].kind;
}

std::string Parser::describe(const Token &token) const {
  if (token.kind == TokenKind::EndOfFile)
    return std::string(spelling(token.kind));
  if (token.kind == TokenKind::String)
    return "a string";
  constexpr std::size_t longToken = 40;
  std::string_view written = text(token);
  if (written.size() <= longToken)
    return fmt::format("'{}'", written);
  written = written.substr(0, longToken);
  return fmt::format("'{}…'", written.substr(0, findInvalid(written)));
}

// What is missing before a token on a new line is missing at the end of the previous one.
Span Parser::errorSpan() const {
  const Token &token = current();
  const bool isBehind = position_ > itemStart_ && (token.startsLine || token.kind == TokenKind::EndOfFile);
  return isBehind ? Span{file_, previous().end, previous().end} : span(token);
}

Diagnostic &Parser::unexpected(std::string_view expected) {
  // Strings may span lines, so that a missing quote shows itself at the next string only.
  const Token &string = previous();
  const std::size_t lineEnd = string.kind == TokenKind::String ? text(string).find_first_of("\r\n") : std::string_view::npos;
  if (!recovering_ && lineEnd != std::string_view::npos && !current().startsLine) {
    Diagnostic &diagnostic = fail(UnterminatedString, Span{file_, string.begin, string.begin + static_cast<std::uint32_t>(lineEnd)});
    // The string explains what follows only if it has been reported.
    if (&diagnostic != &silent_)
      unreliableFrom_ = std::min(unreliableFrom_, string.begin);
    return diagnostic;
  }
  return fail(UnexpectedToken, errorSpan(), expected, describe(current()));
}

bool Parser::expect(TokenKind kind) {
  if (accept(kind))
    return true;
  unexpected(fmt::format("'{}'", spelling(kind)));
  return false;
}

// Whether an element, an equation, a statement or a section can start with the token: before it a ';' is missing, otherwise it is wrong.
bool Parser::startsSomething(const Token &token) const {
  switch (token.kind) {
  case TokenKind::EndOfFile:
    return true;
  case TokenKind::Identifier:
  case TokenKind::Dot:
  case TokenKind::LeftParenthesis:
  case TokenKind::Integer:
  case TokenKind::Real:
    return token.startsLine;
  case TokenKind::And:
  case TokenKind::Constrainedby:
  case TokenKind::Each:
  case TokenKind::Else:
  case TokenKind::Elseif:
  case TokenKind::False:
  case TokenKind::If:
  case TokenKind::In:
  case TokenKind::Loop:
  case TokenKind::Not:
  case TokenKind::Or:
  case TokenKind::Then:
  case TokenKind::True:
    return token.startsLine && token.kind != TokenKind::Constrainedby;
  default:
    return isKeyword(token.kind);
  }
}

void Parser::expectSemicolon() {
  const bool endMissing = std::exchange(endMissing_, false);
  if (recovering_ || accept(TokenKind::Semicolon) || endMissing)
    return;
  if (!startsSomething(current())) {
    unexpected("';'");
    return;
  }
  // At the end of the file inside a class more is missing than a ';'.
  if (at(TokenKind::EndOfFile) && !openClasses_.empty())
    return;
  const Token &last = previous();
  complain(MissingSemicolon, Span{file_, last.end, last.end}, describe(last));
}

// A ',' in a list in brackets; also a ';' in its place, which shows itself by the closing bracket that follows.
bool Parser::acceptSeparator(TokenKind closing) {
  if (!at(TokenKind::Semicolon))
    return accept(TokenKind::Comma);
  int depth = 0;
  for (std::size_t ahead = 1;; ++ahead) {
    const TokenKind kind = peek(ahead).kind;
    if (kind == TokenKind::Semicolon || isStructural(peek(ahead), ahead))
      return false;
    if (kind == TokenKind::LeftParenthesis || kind == TokenKind::LeftBracket || kind == TokenKind::LeftBrace)
      ++depth;
    if (kind != TokenKind::RightParenthesis && kind != TokenKind::RightBracket && kind != TokenKind::RightBrace)
      continue;
    if (depth == 0) {
      if (kind != closing)
        return false;
      complain(UnexpectedToken, span(current()), "','", describe(current()));
      advance();
      return true;
    }
    --depth;
  }
}

void Parser::expectClosing(TokenKind closing, const Token &opening, std::string_view separators) {
  if (recovering_ || accept(closing))
    return;
  const bool isClosed = atAny({TokenKind::Semicolon, TokenKind::EndOfFile, TokenKind::RightParenthesis, TokenKind::RightBracket,
                               TokenKind::RightBrace, TokenKind::Then, TokenKind::Loop, TokenKind::End, TokenKind::Equation,
                               TokenKind::Algorithm, TokenKind::Annotation, TokenKind::String});
  if (isClosed || current().startsLine)
    fail(MissingBracket, errorSpan(), spelling(closing), describe(current()))
        .note(span(opening), fmt::format("it would close this '{}'", text(opening)));
  else
    unexpected(fmt::format("{} or '{}'", separators, spelling(closing)));
}

// Whether the token cannot stand inside an element or equation, so that skipping stops before it.
bool Parser::isStructural(const Token &token, std::size_t ahead) const {
  const TokenKind next = peek(ahead + 1).kind;
  switch (token.kind) {
  case TokenKind::EndOfFile:
  case TokenKind::Equation:
  case TokenKind::Algorithm:
  case TokenKind::Public:
  case TokenKind::Protected:
  case TokenKind::External:
    return true;
  case TokenKind::Initial:
    return next == TokenKind::Equation || next == TokenKind::Algorithm;
  case TokenKind::End:
    return next == TokenKind::Identifier || next == TokenKind::If || next == TokenKind::For || next == TokenKind::When ||
           next == TokenKind::While || next == TokenKind::Semicolon || next == TokenKind::EndOfFile ||
           (token.startsLine && peek(ahead + 1).startsLine);
  case TokenKind::Else:
  case TokenKind::Elseif:
  case TokenKind::Elsewhen:
    return token.startsLine && !openBlocks_.empty();
  case TokenKind::Import:
  case TokenKind::Extends:
  case TokenKind::Model:
  case TokenKind::Block:
  case TokenKind::Package:
  case TokenKind::Record:
  case TokenKind::Connector:
  case TokenKind::Class:
  case TokenKind::Encapsulated:
  case TokenKind::Partial:
  case TokenKind::Parameter:
  case TokenKind::Constant:
  case TokenKind::Discrete:
  case TokenKind::When:
  case TokenKind::Connect:
    return token.startsLine;
  default:
    return false;
  }
}

// Whether a ']' follows before anything that cannot stand in a matrix: a ';' here separates rows.
bool Parser::isInsideMatrix() const {
  if (!failedInMatrix_)
    return false;
  int depth = 0;
  for (std::size_t ahead = 1;; ++ahead) {
    const Token &token = peek(ahead);
    if (isStructural(token, ahead) || token.kind == TokenKind::Equal || token.kind == TokenKind::Assign)
      return false;
    if (token.kind == TokenKind::LeftBracket)
      ++depth;
    else if (token.kind == TokenKind::RightBracket && --depth < 0)
      return true;
  }
}

// Skips the rest of what could not be read: behind the next ';', or before what starts something else.
void Parser::synchronize() {
  int brackets = 0;
  while (!isStructural(current(), 0)) {
    const TokenKind kind = current().kind;
    if (kind == TokenKind::LeftBracket)
      ++brackets;
    else if (kind == TokenKind::RightBracket)
      brackets = std::max(0, brackets - 1);
    const bool separatesRows = brackets > 0 || isInsideMatrix();
    ++position_;
    if (kind == TokenKind::Semicolon && !separatesRows)
      break;
  }
  failedInMatrix_ = false;
  resume();
}

Parser::Nesting::Nesting(Parser &parser) : parser_(parser) {
  if (++parser_.nesting_ > ast::maxNesting)
    parser_.fail(TooDeep, parser_.span(parser_.current()), ast::maxNesting);
}

// ---- names -----------------------------------------------------------------------------------------------------------------------

// `block` and the like begin a class only before a name, so that elsewhere they can be names: `body block(mass = 2)`.
bool Parser::atClassWordAsName() const {
  if (!atAny({TokenKind::Block, TokenKind::Class, TokenKind::Connector, TokenKind::Model, TokenKind::Package, TokenKind::Record,
              TokenKind::Type}))
    return false;
  const TokenKind next = peek(1).kind;
  return next != TokenKind::Identifier && next != TokenKind::Extends;
}

ast::Name Parser::parseName(std::string_view what) {
  const Token &token = current();
  if (at(TokenKind::Identifier) || atClassWordAsName()) {
    advance();
    return {text(token), span(token)};
  }
  // A keyword on the same line was meant as a name.
  if (!recovering_ && isKeyword(token.kind) && !token.startsLine && token.kind != TokenKind::Annotation) {
    complain(KeywordAsName, span(token), text(token));
    advance();
    return {text(token), span(token)};
  }
  unexpected(what);
  return {{}, Span{file_, token.begin, token.begin}};
}

ast::Reference Parser::parseDotted(std::string_view what, bool withSubscripts) {
  ast::Reference reference;
  const std::uint32_t begin = here();
  reference.leadingDot = accept(TokenKind::Dot);
  auto parts = list<ast::ReferencePart>();
  do {
    ast::ReferencePart part;
    part.name = parseName(what);
    if (withSubscripts && at(TokenKind::LeftBracket)) {
      part.hasSubscripts = true;
      part.subscripts = parseSubscripts();
    }
    parts.push(part);
  } while (accept(TokenKind::Dot));
  reference.parts = parts.finish(arena_);
  reference.span = since(begin);
  return reference;
}

ast::List<ast::Expr *> Parser::parseSubscripts() {
  const Token &opening = current();
  advance();
  ++subscripts_;
  auto subscripts = list<ast::Expr *>();
  do {
    if (at(TokenKind::Colon)) {
      const std::uint32_t begin = here();
      advance();
      ast::Expr *colon = newExpr(ast::ExprKind::Colon, begin);
      subscripts.push(finish(colon));
    } else {
      subscripts.push(parseBracketed());
    }
  } while (accept(TokenKind::Comma));
  expectClosing(TokenKind::RightBracket, opening);
  --subscripts_;
  return subscripts.finish(arena_);
}

}  // namespace tf::syntax
