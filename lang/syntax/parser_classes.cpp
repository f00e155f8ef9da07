// Files, class definitions and their sections (MLS A.2.1, A.2.2).
#include "lang/syntax/parser_core.h"

namespace tf::syntax {

using ast::ClassForm;
using ast::Restriction;

// ---- files -----------------------------------------------------------------------------------------------------------------------

ast::File *Parser::parseFile() {
  auto *file = arena_.make<ast::File>();
  auto classes = list<ast::ClassDefinition *>();
  while (current().kind != TokenKind::EndOfFile) {
    const Token &first = current();
    if (at(TokenKind::Within)) {
      if (position_ > 0)
        complain(MisplacedWithin, span(first));
      parseWithin(*file);
      continue;
    }
    const bool isFinal = accept(TokenKind::Final);
    repairMisspelledClass();
    if (!atClass()) {
      complain(ExpectedClass, span(current()), describe(current()));
      skipToClass();
      continue;
    }
    classes.push(parseClass());
    classes.back()->isFinal = isFinal;
    classes.back()->span.begin = first.begin;
    expectSemicolon();
    if (recovering_) {
      synchronize();
      if (!atClass())
        skipToClass();
    }
  }
  file->classes = classes.finish(arena_);
  auto comments = list<Span>();
  for (const Span &comment : comments_)
    comments.push(comment);
  file->comments = comments.finish(arena_);
  return file;
}

// What cannot begin a class is part of the mistake that was reported before it.
void Parser::skipToClass() {
  do {
    advance();
  } while (!at(TokenKind::EndOfFile) && !(current().startsLine && (atClass() || at(TokenKind::Within) || at(TokenKind::Final))));
}

void Parser::parseWithin(ast::File &file) {
  advance();
  file.hasWithin = true;
  if (!at(TokenKind::Semicolon))
    file.within = parseTypeName("the name of a package");
  expectSemicolon();
}

// ---- heads of classes ------------------------------------------------------------------------------------------------------------

// `optimization IDENT` begins a class at top level and in packages.
bool Parser::atOptimization() const {
  if (enclosing_ != Restriction::Package || !atWord("optimization") || peek(1).kind != TokenKind::Identifier)
    return false;
  const TokenKind next = peek(2).kind;
  return openClasses_.empty() || (next != TokenKind::Semicolon && next != TokenKind::Comma && next != TokenKind::LeftBracket);
}

// An optimization class in a model: `optimization IDENT [(…)] {STRING}` and then on the next line no end of a declaration.
bool Parser::atMisplacedOptimization() const {
  if (enclosing_ == Restriction::Package || !atWord("optimization") || peek(1).kind != TokenKind::Identifier)
    return false;
  std::size_t ahead = 2;
  if (peek(ahead).kind == TokenKind::LeftParenthesis) {
    int depth = 0;
    do {
      const TokenKind kind = peek(ahead++).kind;
      if (kind == TokenKind::EndOfFile || kind == TokenKind::Semicolon)
        return false;
      depth += kind == TokenKind::LeftParenthesis ? 1 : kind == TokenKind::RightParenthesis ? -1 : 0;
    } while (depth > 0);
  }
  while (peek(ahead).kind == TokenKind::String || peek(ahead).kind == TokenKind::Plus)
    ++ahead;
  const TokenKind kind = peek(ahead).kind;
  return peek(ahead).startsLine && (kind == TokenKind::Extends || kind == TokenKind::Identifier || kind == TokenKind::Parameter ||
                                    kind == TokenKind::Equation || kind == TokenKind::End);
}

bool Parser::atClass() const {
  if (peek(1).kind == TokenKind::Dot)
    return false;
  switch (kind_) {
  case TokenKind::Encapsulated:
  case TokenKind::Partial:
  case TokenKind::Class:
  case TokenKind::Model:
  case TokenKind::Operator:
  case TokenKind::Record:
  case TokenKind::Block:
  case TokenKind::Expandable:
  case TokenKind::Connector:
  case TokenKind::Type:
  case TokenKind::Package:
  case TokenKind::Pure:
  case TokenKind::Impure:
  case TokenKind::Function:
    return true;
  case TokenKind::Identifier:
    return atOptimization() || atMisplacedOptimization();
  default:
    return false;
  }
}

ast::ClassDefinition *Parser::parseClass(bool inModification) {
  auto *definition = arena_.make<ast::ClassDefinition>();
  const std::uint32_t begin = here();
  const Nesting nesting(*this);
  if (nesting.tooDeep())
    return definition;
  if (atMisplacedOptimization())
    complain(MisplacedOptimization, span(current()));
  if (!parseClassPrefixes(*definition))
    return definition;
  const bool isOptimization = definition->restriction == Restriction::Optimization;
  if (!recovering_ && accept(TokenKind::Extends)) {
    definition->form = ClassForm::LongExtends;
    definition->name = parseName("the name of the class to extend");
    if (at(TokenKind::LeftParenthesis))
      definition->modification = parseClassModification();
    parseLongClass(*definition);
  } else {
    definition->name = parseName("the name of the class");
    if (at(TokenKind::Equal)) {
      if (isOptimization)
        complain(ShortOptimization, span(current()));
      advance();
      parseShortClass(*definition);
    } else {
      if (inModification)
        complain(LongClassInModifier, definition->name.span, definition->name.text);
      if (isOptimization && at(TokenKind::LeftParenthesis)) {
        // The heading belongs to the class: `objective = q[1](finalTime)`.
        const Restriction enclosing = std::exchange(enclosing_, Restriction::Optimization);
        definition->modification = parseClassModification();
        enclosing_ = enclosing;
      }
      parseLongClass(*definition);
    }
  }
  definition->span = since(begin);
  return definition;
}

// False, with an error, if no keyword says what the class is.
bool Parser::parseClassPrefixes(ast::ClassDefinition &definition) {
  definition.isEncapsulated = accept(TokenKind::Encapsulated);
  definition.isPartial = accept(TokenKind::Partial);
  if (at(TokenKind::Encapsulated)) {
    complain(PrefixOrder, span(current()), "encapsulated", "partial");
    definition.isEncapsulated = accept(TokenKind::Encapsulated);
  }
  definition.isPure = accept(TokenKind::Pure);
  definition.isImpure = !definition.isPure && accept(TokenKind::Impure);
  definition.isExpandable = accept(TokenKind::Expandable);
  const bool isOperator = accept(TokenKind::Operator);
  const auto restriction = [&](Restriction value) {
    definition.restriction = value;
    advance();
    return true;
  };
  switch (kind_) {
  case TokenKind::Function:
    return restriction(isOperator ? Restriction::OperatorFunction : Restriction::Function);
  case TokenKind::Record:
    return restriction(isOperator ? Restriction::OperatorRecord : Restriction::Record);
  case TokenKind::Connector:
    return restriction(Restriction::Connector);
  default:
    break;
  }
  if (isOperator) {
    definition.restriction = Restriction::Operator;
    return true;
  }
  if (definition.isPure || definition.isImpure || definition.isExpandable)
    complain(UnexpectedToken, span(current()), definition.isExpandable ? "'connector'" : "'function'", describe(current()));
  switch (kind_) {
  case TokenKind::Class:
    return restriction(Restriction::Class);
  case TokenKind::Model:
    return restriction(Restriction::Model);
  case TokenKind::Block:
    return restriction(Restriction::Block);
  case TokenKind::Type:
    return restriction(Restriction::Type);
  case TokenKind::Package:
    return restriction(Restriction::Package);
  default:
    if (atWord("optimization"))
      return restriction(Restriction::Optimization);
    unexpected("a class, as in 'model' or 'function'");
    return false;
  }
}

// ---- short forms -----------------------------------------------------------------------------------------------------------------

void Parser::parseShortClass(ast::ClassDefinition &definition) {
  if (at(TokenKind::Enumeration))
    return parseEnumeration(definition);
  if (at(TokenKind::Der))
    return parseDerClass(definition);
  definition.form = ClassForm::Short;
  if (accept(TokenKind::Input))
    definition.causality = ast::Causality::Input;
  else if (accept(TokenKind::Output))
    definition.causality = ast::Causality::Output;
  definition.base = parseTypeName("the name of a class");
  if (at(TokenKind::LeftBracket)) {
    definition.hasSubscripts = true;
    definition.subscripts = parseSubscripts();
  }
  if (at(TokenKind::LeftParenthesis))
    definition.modification = parseClassModification();
  definition.comment = parseComment();
}

void Parser::parseEnumeration(ast::ClassDefinition &definition) {
  definition.form = ClassForm::Enumeration;
  advance();
  const Token &opening = current();
  if (!expect(TokenKind::LeftParenthesis))
    return;
  if (accept(TokenKind::Colon)) {
    definition.isOpenEnumeration = true;
  } else if (!at(TokenKind::RightParenthesis)) {
    auto literals = list<ast::EnumerationLiteral>();
    do {
      ast::EnumerationLiteral literal;
      literal.name = parseName("the name of an enumeration literal");
      literal.comment = parseComment();
      literals.push(literal);
    } while (accept(TokenKind::Comma));
    definition.literals = literals.finish(arena_);
  }
  expectClosing(TokenKind::RightParenthesis, opening);
  definition.comment = parseComment();
}

void Parser::parseDerClass(ast::ClassDefinition &definition) {
  definition.form = ClassForm::Der;
  advance();
  const Token &opening = current();
  if (!expect(TokenKind::LeftParenthesis))
    return;
  definition.base = parseTypeName("the name of a function");
  auto names = list<ast::Name>();
  expect(TokenKind::Comma);
  do {
    names.push(parseName("the name of an input"));
  } while (accept(TokenKind::Comma));
  expectClosing(TokenKind::RightParenthesis, opening);
  definition.derivativeVariables = names.finish(arena_);
  definition.comment = parseComment();
}

// ---- long forms ------------------------------------------------------------------------------------------------------------------

// A broken first line does not take the body with it.
void Parser::skipBrokenHeading() {
  while (current().kind != TokenKind::EndOfFile && !current().startsLine && current().kind != TokenKind::Semicolon)
    ++position_;
  if (current().kind == TokenKind::Semicolon)
    ++position_;
  resume();
}

void Parser::parseLongClass(ast::ClassDefinition &definition) {
  if (recovering_)
    skipBrokenHeading();
  const Restriction enclosing = std::exchange(enclosing_, definition.restriction);
  const bool inConstraints = std::exchange(inConstraints_, false);
  const bool equationReported = std::exchange(equationReported_, false);
  const std::vector<TokenKind> openBlocks = std::exchange(openBlocks_, {});
  openClasses_.push_back(definition.name.text);
  definition.comment = parseDescription();
  if (!recovering_ && !current().startsLine && !startsSomething(current()) && !at(TokenKind::Identifier) && !at(TokenKind::Semicolon))
    unexpected("the elements of the class");
  else if (at(TokenKind::Semicolon))
    unexpected("the elements of the class");
  if (recovering_)
    skipBrokenHeading();
  parseComposition(definition);
  openClasses_.pop_back();
  openBlocks_ = openBlocks;
  inConstraints_ = inConstraints;
  equationReported_ = equationReported;
  enclosing_ = enclosing;
  parseEndOfClass(definition);
}

void Parser::parseEndOfClass(ast::ClassDefinition &definition) {
  const Token &end = current();
  const ast::Name &name = definition.name;
  const std::string wanted = fmt::format("end {}", name.text);
  if (end.kind == TokenKind::EndOfFile) {
    if (!endReported_)
      complain(MissingEnd, Span{file_, previous().end, previous().end}, name.text, wanted)
          .note(name.span, fmt::format("'{}' begins here", name.text));
    endReported_ = true;
    endMissing_ = true;
    return;
  }
  const Token &written = peek(1);
  const bool isName = written.kind == TokenKind::Identifier;
  const bool closesOuter =
      isName && text(written) != name.text && std::find(openClasses_.begin(), openClasses_.end(), text(written)) != openClasses_.end();
  if (closesOuter) {
    complain(MissingEnd, cover(span(end), span(written)), name.text, wanted).note(name.span, fmt::format("'{}' begins here", name.text));
    endMissing_ = true;
    return;
  }
  advance();
  if (isName) {
    advance();
    definition.endName = {text(written), span(written)};
    if (text(written) != name.text && !name.text.empty())
      complain(MismatchedEnd, span(written), text(written), name.text, name.text)
          .note(name.span, fmt::format("'{}' begins here", name.text));
    return;
  }
  if (name.text.empty()) {
    while (current().kind != TokenKind::EndOfFile && !current().startsLine && current().kind != TokenKind::Semicolon)
      advance();
    return;
  }
  complain(UnexpectedToken, span(written), fmt::format("'{}'", wanted), describe(written));
  if (!written.startsLine && written.kind != TokenKind::Semicolon)
    advance();
}

void Parser::parseComposition(ast::ClassDefinition &definition) {
  auto elements = list<ast::Element>();
  auto sections = list<ast::Section>();
  bool isProtected = false;
  while (true) {
    const std::size_t start = itemStart_ = position_;
    if (!parseCompositionItem(definition, elements, sections, isProtected))
      break;
    if (recovering_)
      synchronize();
    if (position_ == start)
      advance();
  }
  definition.elements = elements.finish(arena_);
  definition.sections = sections.finish(arena_);
}

// One element, section or annotation; false at the end of the class.
bool Parser::parseCompositionItem(ast::ClassDefinition &definition, ast::ListBuilder<ast::Element> &elements,
                                  ast::ListBuilder<ast::Section> &sections, bool &isProtected) {
  if (at(TokenKind::EndOfFile))
    return false;
  if (at(TokenKind::End)) {
    // `end if` and the like close nothing here.
    const TokenKind closed = peek(1).kind;
    if (closed != TokenKind::If && closed != TokenKind::For && closed != TokenKind::When && closed != TokenKind::While)
      return false;
    fail(UnexpectedToken, cover(span(current()), span(peek(1))), fmt::format("'end {}'", definition.name.text),
         fmt::format("'end {}'", text(peek(1))));
    position_ += 2;
    return true;
  }
  if (at(TokenKind::Public) || at(TokenKind::Protected)) {
    isProtected = at(TokenKind::Protected);
    advance();
    return true;
  }
  if (at(TokenKind::Annotation)) {
    parseClassAnnotation(definition);
    return true;
  }
  if (at(TokenKind::External)) {
    parseExternal(definition);
    return true;
  }
  if (atSection()) {
    sections.push(parseSection());
    return true;
  }
  if (parseMisspelledSection(sections, isProtected))
    return true;
  const std::size_t start = position_;
  const ast::Element element = parseElement(isProtected);
  // Of an equation in a class that the element contains, that class has made what it could: reading the element again would read it twice
  // on each level of nesting.
  if (std::exchange(foundEquation_, false) && itemStart_ == start) {
    // Read as if the keyword stood here.
    resume();
    rewind(start);
    sections.push(parseStraySection());
    return true;
  }
  elements.push(element);
  expectSemicolon();
  return true;
}

void Parser::parseClassAnnotation(ast::ClassDefinition &definition) {
  const Token &token = current();
  ast::Modification *annotation = parseAnnotation();
  expectSemicolon();
  if (definition.annotation != nullptr || !(recovering_ || at(TokenKind::End) || at(TokenKind::EndOfFile)))
    complain(MisplacedAnnotation, span(token));
  definition.annotation = annotation;
}

void Parser::parseExternal(ast::ClassDefinition &definition) {
  auto *external = arena_.make<ast::External>();
  const Token &token = current();
  if (definition.external != nullptr)
    complain(MisplacedExternal, span(token));
  definition.external = external;
  advance();
  if (at(TokenKind::String)) {
    external->language = text(current());
    advance();
  }
  if (!atAny({TokenKind::Semicolon, TokenKind::Annotation})) {
    const std::size_t start = position_;
    ast::Reference reference = parseReference();
    if (accept(TokenKind::Equal)) {
      external->hasOutput = true;
      external->output = reference;
    } else {
      resume();
      rewind(start);
    }
    external->function = parseName("the name of the external function");
    const Token &opening = current();
    if (expect(TokenKind::LeftParenthesis) && !accept(TokenKind::RightParenthesis)) {
      auto arguments = list<ast::Expr *>();
      do {
        arguments.push(parseBracketed());
      } while (accept(TokenKind::Comma));
      expectClosing(TokenKind::RightParenthesis, opening);
      external->arguments = arguments.finish(arena_);
    }
  }
  if (at(TokenKind::Annotation))
    external->annotation = parseAnnotation();
  external->span = since(token.begin);
  expectSemicolon();
  if (!(recovering_ || atAny({TokenKind::End, TokenKind::EndOfFile, TokenKind::Annotation, TokenKind::External})))
    complain(MisplacedExternal, span(token));
}

}  // namespace tf::syntax
