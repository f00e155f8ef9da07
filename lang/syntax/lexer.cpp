#include "lang/syntax/lexer.h"

#include "lang/base/utf8.h"
#include "lang/syntax/syntax_diagnostics.h"

#include <array>

namespace tf::syntax {

namespace {

enum CharacterClass : std::uint8_t { Other, Blank, LineBreak, Letter, Digit, Punctuation };

constexpr std::array<std::uint8_t, 256> makeClasses() {
  std::array<std::uint8_t, 256> classes{};
  for (const char c : {' ', '\t', '\v', '\f'})
    classes[static_cast<unsigned char>(c)] = Blank;
  classes['\n'] = classes['\r'] = LineBreak;
  for (unsigned c = 'a'; c <= 'z'; ++c)
    classes[c] = classes[c - 'a' + 'A'] = Letter;
  classes['_'] = Letter;
  for (unsigned c = '0'; c <= '9'; ++c)
    classes[c] = Digit;
  for (const char c : {'(', ')', '[', ']', '{', '}', '.', ',', ';', ':', '=', '<', '>', '+', '-', '*', '/', '^'})
    classes[static_cast<unsigned char>(c)] = Punctuation;
  return classes;
}

constexpr std::array<std::uint8_t, 256> characterClasses = makeClasses();

// Operators of other languages: what is written, what is meant.
struct ForeignOperator {
  std::string_view written, meant;
  TokenKind kind;
};

constexpr ForeignOperator foreignOperators[] = {
    {"!=", "<>", TokenKind::NotEqual}, {"~=", "<>", TokenKind::NotEqual}, {"&&", "and", TokenKind::And}, {"||", "or", TokenKind::Or},
    {"&", "and", TokenKind::And},      {"|", "or", TokenKind::Or},        {"!", "not", TokenKind::Not},  {"**", "^", TokenKind::Power},
};

class Lexer {
public:
  Lexer(std::string_view text, FileId file, Diagnostics &diagnostics) : text_(text), file_(file), diagnostics_(diagnostics) {
    result_.tokens.reserve(text.size() / 5 + 8);
  }

  LexedText run() {
    checkEncoding();
    while (position_ < text_.size() && position_ < result_.unreliableFrom)
      next();
    position_ = text_.size();
    push(TokenKind::EndOfFile, position_);
    return std::move(result_);
  }

private:
  [[nodiscard]] char at(std::size_t position) const { return position < text_.size() ? text_[position] : '\0'; }
  [[nodiscard]] std::uint8_t classAt(std::size_t position) const {
    return position < text_.size() ? characterClasses[static_cast<unsigned char>(text_[position])] : static_cast<std::uint8_t>(Other);
  }
  [[nodiscard]] bool isWordAt(std::size_t position) const { return classAt(position) == Letter || classAt(position) == Digit; }
  [[nodiscard]] Span span(std::size_t begin, std::size_t end) const {
    return {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  }
  void push(TokenKind kind, std::size_t begin) {
    result_.tokens.push_back({kind, startsLine_, followsError_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(position_)});
    startsLine_ = followsError_ = false;
  }
  void unreliableFrom(std::size_t position) {
    result_.unreliableFrom = std::min(result_.unreliableFrom, static_cast<std::uint32_t>(position));
  }

  void checkEncoding();
  void next();
  void word();
  void number();
  void string();
  void quotedName();
  void punctuation();
  void dot();
  void lineComment();
  void blockComment();
  void other();
  bool foreignOperator();
  void foreignWord(std::size_t begin);
  void escape(std::size_t begin);
  std::size_t digits(std::size_t position) const;

  std::string_view text_;
  FileId file_;
  Diagnostics &diagnostics_;
  LexedText result_;
  std::size_t position_ = 0;
  bool startsLine_ = true;
  bool followsError_ = false;
};

void Lexer::checkEncoding() {
  if (text_.starts_with("\xEF\xBB\xBF"))
    position_ = 3;
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
    diagnostics_.report(InvalidUtf8, span(0, 2), "the file seems to be UTF-16, which");
    unreliableFrom(0);
    return;
  }
  // One report per run of invalid bytes; after some of them the file is taken for something else than text.
  constexpr int manyErrors = 10;
  int errors = 0;
  for (std::size_t begin = findInvalid(text_); begin < text_.size();) {
    std::size_t end = begin + 1;
    while (end < text_.size() && findInvalid(text_.substr(end, 4)) == 0)
      ++end;
    diagnostics_.report(InvalidUtf8, span(begin, end), fmt::format("the byte 0x{:02X}", static_cast<unsigned char>(text_[begin])));
    if (++errors == manyErrors) {
      unreliableFrom(end);
      return;
    }
    begin = findInvalid(text_, end);
  }
}

void Lexer::next() {
  switch (classAt(position_)) {
  case Blank:
    ++position_;
    return;
  case LineBreak:
    ++position_;
    startsLine_ = true;
    return;
  case Letter:
    return word();
  case Digit:
    return number();
  case Punctuation:
    return punctuation();
  default:
    return other();
  }
}

void Lexer::word() {
  const std::size_t begin = position_;
  while (isWordAt(position_))
    ++position_;
  push(keyword(text_.substr(begin, position_ - begin)), begin);
}

std::size_t Lexer::digits(std::size_t position) const {
  while (classAt(position) == Digit)
    ++position;
  return position;
}

void Lexer::number() {
  const std::size_t begin = position_;
  TokenKind kind = TokenKind::Integer;
  position_ = digits(position_);
  if (at(position_) == '.') {
    kind = TokenKind::Real;
    position_ = digits(position_ + 1);
  }
  if (at(position_) == 'e' || at(position_) == 'E') {
    const bool hasSign = at(position_ + 1) == '+' || at(position_ + 1) == '-';
    const std::size_t exponent = position_ + (hasSign ? 2 : 1);
    if (classAt(exponent) == Digit) {
      kind = TokenKind::Real;
      position_ = digits(exponent);
    } else if (hasSign || !isWordAt(exponent)) {
      // `1else` is a number and a keyword, `1e` is a mistake.
      position_ = exponent;
      kind = TokenKind::Real;
      diagnostics_.report(MalformedNumber, span(begin, position_), text_.substr(begin, position_ - begin));
    }
  }
  push(kind, begin);
}

void Lexer::escape(std::size_t begin) {
  constexpr std::string_view escapes = "'\"?\\abfnrtv";
  if (position_ < text_.size() && escapes.find(text_[position_]) != std::string_view::npos) {
    ++position_;
    return;
  }
  const std::size_t length = position_ < text_.size() && classAt(position_) != LineBreak ? decode(text_.substr(position_)).length : 0;
  position_ += length;
  diagnostics_.report(InvalidEscape, span(begin, position_), text_.substr(begin, position_ - begin));
}

void Lexer::string() {
  const std::size_t begin = position_++;
  while (position_ < text_.size()) {
    const char c = text_[position_++];
    if (c == '"')
      return push(TokenKind::String, begin);
    if (c == '\\')
      escape(position_ - 1);
    else if (c == '\0')
      diagnostics_.report(InvalidCharacter, span(position_ - 1, position_), "U+0000 in a string");
  }
  const std::size_t lineEnd = std::min(text_.find_first_of("\r\n", begin), text_.size());
  diagnostics_.report(UnterminatedString, span(begin, lineEnd));
  unreliableFrom(begin);
  push(TokenKind::String, begin);
}

void Lexer::quotedName() {
  const std::size_t begin = position_++;
  while (position_ < text_.size() && classAt(position_) != LineBreak) {
    const char c = text_[position_++];
    if (c == '\'') {
      if (position_ == begin + 2)
        diagnostics_.report(EmptyName, span(begin, position_));
      return push(TokenKind::Identifier, begin);
    }
    if (c == '\\')
      escape(position_ - 1);
    else if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7F) {
      const CodePoint point = decode(text_.substr(position_ - 1));
      const std::size_t length = std::max<std::size_t>(point.length, 1);
      if (point.length > 0)
        diagnostics_.report(InvalidCharacter, span(position_ - 1, position_ - 1 + length),
                            fmt::format("U+{:04X}; a quoted name consists of printable ASCII characters", point.value));
      position_ += length - 1;
    }
  }
  // Read on before what probably stands behind the name.
  position_ = std::min(text_.find_first_of(";,=()[]\r\n", begin + 1), text_.size());
  while (classAt(position_ - 1) == Blank)
    --position_;
  diagnostics_.report(UnterminatedName, span(begin, position_));
  push(TokenKind::Identifier, begin);
}

void Lexer::lineComment() {
  const std::size_t begin = position_;
  while (position_ < text_.size() && classAt(position_) != LineBreak)
    ++position_;
  result_.comments.push_back(span(begin, position_));
}

void Lexer::blockComment() {
  const std::size_t begin = position_;
  const std::size_t close = text_.find("*/", begin + 2);
  if (close == std::string_view::npos) {
    diagnostics_.report(UnterminatedComment, span(begin, begin + 2));
    unreliableFrom(begin);
    position_ = text_.size();
  } else {
    position_ = close + 2;
  }
  const std::string_view comment = text_.substr(begin, position_ - begin);
  startsLine_ = startsLine_ || comment.find_first_of("\r\n") != std::string_view::npos;
  result_.comments.push_back(span(begin, position_));
}

void Lexer::punctuation() {
  const std::size_t begin = position_;
  const char next = at(position_ + 1);
  const auto take = [&](TokenKind kind, std::size_t length) {
    position_ += length;
    push(kind, begin);
  };
  switch (text_[position_]) {
  case '(':
    return take(TokenKind::LeftParenthesis, 1);
  case ')':
    return take(TokenKind::RightParenthesis, 1);
  case '[':
    return take(TokenKind::LeftBracket, 1);
  case ']':
    return take(TokenKind::RightBracket, 1);
  case '{':
    return take(TokenKind::LeftBrace, 1);
  case '}':
    return take(TokenKind::RightBrace, 1);
  case ',':
    return take(TokenKind::Comma, 1);
  case ';':
    return take(TokenKind::Semicolon, 1);
  case ':':
    return next == '=' ? take(TokenKind::Assign, 2) : take(TokenKind::Colon, 1);
  case '=':
    return next == '=' ? take(TokenKind::EqualEqual, 2) : take(TokenKind::Equal, 1);
  case '<':
    return next == '=' ? take(TokenKind::LessEqual, 2) : next == '>' ? take(TokenKind::NotEqual, 2) : take(TokenKind::Less, 1);
  case '>':
    return next == '=' ? take(TokenKind::GreaterEqual, 2) : take(TokenKind::Greater, 1);
  case '+':
    return take(TokenKind::Plus, 1);
  case '-':
    return take(TokenKind::Minus, 1);
  case '*':
    if (next == '*')
      return other();
    return take(TokenKind::Times, 1);
  case '/':
    if (next == '/')
      return lineComment();
    if (next == '*')
      return blockComment();
    return take(TokenKind::Divide, 1);
  case '^':
    return take(TokenKind::Power, 1);
  default:
    return dot();
  }
}

// An element-wise operator, the start of a number or an access.
void Lexer::dot() {
  constexpr std::pair<char, TokenKind> operators[] = {{'+', TokenKind::DotPlus},
                                                      {'-', TokenKind::DotMinus},
                                                      {'*', TokenKind::DotTimes},
                                                      {'/', TokenKind::DotDivide},
                                                      {'^', TokenKind::DotPower}};
  const std::size_t begin = position_;
  const char next = at(position_ + 1);
  for (const auto &[character, kind] : operators) {
    if (next != character)
      continue;
    position_ += 2;
    return push(kind, begin);
  }
  if (classAt(position_ + 1) == Digit)
    return number();
  ++position_;
  push(TokenKind::Dot, begin);
}

bool Lexer::foreignOperator() {
  for (const ForeignOperator &foreign : foreignOperators) {
    if (!text_.substr(position_).starts_with(foreign.written))
      continue;
    const std::size_t begin = position_;
    position_ += foreign.written.size();
    diagnostics_.report(UnknownOperator, span(begin, position_), foreign.written, foreign.meant);
    push(foreign.kind, begin);
    return true;
  }
  return false;
}

void Lexer::other() {
  if (text_[position_] == '"')
    return string();
  if (text_[position_] == '\'')
    return quotedName();
  if (foreignOperator())
    return;
  const std::size_t begin = position_;
  const CodePoint point = decode(text_.substr(position_));
  position_ += std::max<std::size_t>(point.length, 1);
  if (point.length == 0)
    return;  // reported by checkEncoding
  // A run of the same character, as of NULs or of letters of another alphabet, is one error.
  const bool isAscii = point.value < 0x80;
  while (position_ < text_.size() && (isAscii ? text_[position_] == text_[begin] : decode(text_.substr(position_)).value >= 0x80))
    position_ += std::max<std::size_t>(decode(text_.substr(position_)).length, 1);
  const bool isPrintable = point.value > 0x20 && point.value != 0x7F && !(point.value >= 0x80 && point.value < 0xA0);
  std::string character = isPrintable ? fmt::format("'{}'", text_.substr(begin, point.length)) : std::string();
  if (!isPrintable || !isAscii)
    character += fmt::format("{}U+{:04X}{}", isPrintable ? " (" : "", point.value, isPrintable ? ")" : "");
  diagnostics_.report(InvalidCharacter, span(begin, position_), character);
  if (isAscii)
    followsError_ = true;
  else
    foreignWord(begin);
}

// Letters of other alphabets are read as part of the name that they stand in.
void Lexer::foreignWord(std::size_t begin) {
  while (isWordAt(position_))
    ++position_;
  std::vector<Token> &tokens = result_.tokens;
  const bool continues =
      !tokens.empty() && tokens.back().end == begin && (tokens.back().kind == TokenKind::Identifier || isKeyword(tokens.back().kind));
  if (!continues)
    return push(TokenKind::Identifier, begin);
  tokens.back().kind = TokenKind::Identifier;
  tokens.back().end = static_cast<std::uint32_t>(position_);
}

}  // namespace

LexedText lex(const SourceManager &sources, FileId file, Diagnostics &diagnostics) {
  return Lexer(sources.file(file).text(), file, diagnostics).run();
}

}  // namespace tf::syntax
