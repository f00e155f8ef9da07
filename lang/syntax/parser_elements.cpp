// Elements of a class: imports, extends clauses, components and their prefixes (MLS A.2.2–A.2.4).
#include "lang/syntax/parser_core.h"

namespace tf::syntax {

namespace {

// Order of the prefixes of an element, and of those of a type; equal ranks exclude each other.
int elementPrefixRank(TokenKind kind) {
  switch (kind) {
  case TokenKind::Redeclare:
    return 1;
  case TokenKind::Final:
    return 2;
  case TokenKind::Inner:
    return 3;
  case TokenKind::Outer:
    return 4;
  case TokenKind::Replaceable:
    return 5;
  default:
    return 0;
  }
}

enum TypePrefixRank : int { NoPrefix, FlowPrefix, VariabilityPrefix, CausalityPrefix };

TypePrefixRank typePrefixRank(TokenKind kind) {
  switch (kind) {
  case TokenKind::Flow:
  case TokenKind::Stream:
    return FlowPrefix;
  case TokenKind::Discrete:
  case TokenKind::Parameter:
  case TokenKind::Constant:
    return VariabilityPrefix;
  case TokenKind::Input:
  case TokenKind::Output:
    return CausalityPrefix;
  default:
    return NoPrefix;
  }
}

void setPrefix(ast::ComponentClause &clause, TokenKind kind) {
  switch (kind) {
  case TokenKind::Flow:
    clause.flow = ast::Flow::Flow;
    break;
  case TokenKind::Stream:
    clause.flow = ast::Flow::Stream;
    break;
  case TokenKind::Discrete:
    clause.variability = ast::Variability::Discrete;
    break;
  case TokenKind::Parameter:
    clause.variability = ast::Variability::Parameter;
    break;
  case TokenKind::Constant:
    clause.variability = ast::Variability::Constant;
    break;
  case TokenKind::Input:
    clause.causality = ast::Causality::Input;
    break;
  case TokenKind::Output:
    clause.causality = ast::Causality::Output;
    break;
  default:
    break;
  }
}

}  // namespace

// `coordinate` is a prefix if after it come `["."] name [subscripts] IDENT`, otherwise a name (language reference, chapter 2).
bool Parser::atCoordinatePrefix() const {
  if (position_ == assumedWord_)
    return true;
  if (!atWord("coordinate"))
    return false;
  // Before another prefix it is an error either way, and as a conflict it is told better.
  return typePrefixRank(peek(1).kind) != NoPrefix || typeAndNameFollow(1, false);
}

// Whether only a declaration can begin here.
bool Parser::atDeclarationPrefix() const {
  return elementPrefixRank(kind_) != 0 || typePrefixRank(kind_) != NoPrefix || at(TokenKind::Import) || at(TokenKind::Extends) ||
         atClass() || atCoordinatePrefix();
}

Parser::ElementPrefixes Parser::parseElementPrefixes() {
  ElementPrefixes prefixes;
  std::optional<Token> last;
  int lastRank = 0;
  for (int rank = elementPrefixRank(kind_); rank != 0; rank = elementPrefixRank(kind_)) {
    const Token &token = current();
    if (rank == lastRank)
      complain(PrefixConflict, span(token), text(*last), text(token));
    else if (rank < lastRank)
      complain(PrefixOrder, span(token), text(token), text(*last));
    prefixes.isRedeclare = prefixes.isRedeclare || at(TokenKind::Redeclare);
    prefixes.isFinal = prefixes.isFinal || at(TokenKind::Final);
    prefixes.isInner = prefixes.isInner || at(TokenKind::Inner);
    prefixes.isOuter = prefixes.isOuter || at(TokenKind::Outer);
    prefixes.isReplaceable = prefixes.isReplaceable || at(TokenKind::Replaceable);
    if (!prefixes.first)
      prefixes.first = token;
    last = token;
    lastRank = rank;
    advance();
  }
  return prefixes;
}

ast::Element Parser::parseElement(bool isProtected) {
  ast::Element element;
  const std::uint32_t begin = here();
  element.isProtected = isProtected;
  if (at(TokenKind::Each)) {
    complain(PrefixNotAllowed, span(current()), "each", "a declaration; it is for modifications");
    advance();
  }
  const ElementPrefixes prefixes = parseElementPrefixes();
  element.isRedeclare = prefixes.isRedeclare;
  element.isFinal = prefixes.isFinal;
  element.isInner = prefixes.isInner;
  element.isOuter = prefixes.isOuter;
  element.isReplaceable = prefixes.isReplaceable;
  if (atAny({TokenKind::Import, TokenKind::Extends}) && prefixes.first)
    complain(PrefixNotAllowed, span(*prefixes.first), text(*prefixes.first), fmt::format("'{}'", text(current())));
  if (at(TokenKind::Import)) {
    element.kind = ast::ElementKind::Import;
    element.import = parseImport();
  } else if (at(TokenKind::Extends)) {
    element.kind = ast::ElementKind::Extends;
    element.extends = parseExtends();
  } else if (repairMisspelledClass(); atClass()) {
    element.kind = ast::ElementKind::Class;
    element.classDefinition = parseClass();
    parseConstraining(*element.classDefinition, element.isReplaceable, true);
  } else {
    element.kind = ast::ElementKind::Component;
    element.component = parseComponentClause(false);
    parseConstraining(*element.component, element.isReplaceable, true);
  }
  element.span = since(begin);
  return element;
}

ast::Import *Parser::parseImport() {
  auto *import = arena_.make<ast::Import>();
  const std::uint32_t begin = here();
  advance();
  if (at(TokenKind::Identifier) && peek(1).kind == TokenKind::Equal) {
    import->kind = ast::ImportKind::Renaming;
    import->alias = parseName("a name");
    advance();
    import->name = parseTypeName("the name of a package or class");
  } else {
    const std::uint32_t nameBegin = here();
    auto parts = list<ast::ReferencePart>();
    do {
      if (!parts.empty() && at(TokenKind::Times)) {
        import->kind = ast::ImportKind::Unqualified;
        advance();
        break;
      }
      if (!parts.empty() && at(TokenKind::LeftBrace)) {
        import->kind = ast::ImportKind::List;
        const Token &opening = current();
        advance();
        auto names = list<ast::Name>();
        do {
          names.push(parseName("a name"));
        } while (accept(TokenKind::Comma));
        expectClosing(TokenKind::RightBrace, opening);
        import->names = names.finish(arena_);
        break;
      }
      ast::ReferencePart part;
      part.name = parseName("the name of a package or class");
      parts.push(part);
      import->name.span = since(nameBegin);
    } while (accept(TokenKind::Dot));
    if (accept(TokenKind::DotTimes))
      import->kind = ast::ImportKind::Unqualified;
    import->name.parts = parts.finish(arena_);
  }
  import->comment = parseComment();
  import->span = since(begin);
  return import;
}

ast::Extends *Parser::parseExtends() {
  auto *extends = arena_.make<ast::Extends>();
  const std::uint32_t begin = here();
  advance();
  extends->base = parseTypeName("the name of a class");
  if (at(TokenKind::LeftParenthesis))
    extends->modification = parseClassModification(true);
  if (at(TokenKind::Annotation))
    extends->annotation = parseAnnotation();
  extends->span = since(begin);
  return extends;
}

void Parser::parseTypePrefix(ast::ComponentClause &clause) {
  const std::uint32_t begin = here();
  std::optional<Token> last, coordinate;
  int lastRank = NoPrefix;
  while (true) {
    repairMisspelledPrefix();
    const Token &token = current();
    const bool isCoordinate = atCoordinatePrefix();
    const int rank = isCoordinate ? VariabilityPrefix : typePrefixRank(kind_);
    if (rank == NoPrefix && (elementPrefixRank(kind_) == 0 || !last))
      break;
    if (rank == NoPrefix)
      complain(PrefixOrder, span(token), text(token), text(*last));
    else if (last && (isCoordinate || coordinate || rank == lastRank))
      complain(PrefixConflict, span(token), text(*last), text(token));
    else if (rank < lastRank)
      complain(PrefixOrder, span(token), text(token), text(*last));
    if (isCoordinate)
      coordinate = token;
    else
      setPrefix(clause, kind_);
    last = token;
    lastRank = std::max(lastRank, rank);
    advance();
  }
  clause.isCoordinate = coordinate.has_value();
  clause.prefixSpan = last ? since(begin) : Span{file_, begin, begin};
}

ast::ComponentClause *Parser::parseComponentClause(bool single) {
  auto *clause = arena_.make<ast::ComponentClause>();
  const std::uint32_t begin = here();
  parseTypePrefix(*clause);
  if (atAny({TokenKind::If, TokenKind::For, TokenKind::While, TokenKind::When, TokenKind::Connect, TokenKind::Der, TokenKind::Initial,
             TokenKind::LeftParenthesis}) &&
      !single && clause->prefixSpan.begin == clause->prefixSpan.end) {
    failAtEquation();
    clause->span = since(begin);
    return clause;
  }
  clause->type = parseTypeName("a declaration");
  if (at(TokenKind::LeftBracket)) {
    clause->hasSubscripts = true;
    clause->subscripts = parseSubscripts();
  }
  if (!single && atEquationInElements(*clause)) {
    failAtEquation();
    clause->span = since(begin);
    return clause;
  }
  parseComponents(*clause, single);
  clause->span = since(begin);
  return clause;
}

// Ends the reading of a declaration, which is an equation; the caller reads it again as that.
void Parser::failAtEquation() {
  if (recovering_)
    return;
  recovering_ = foundEquation_ = true;
  kind_ = recoveryKind;
}

// `x = 1;` or `f(x);` where a declaration should be.
bool Parser::atEquationInElements(const ast::ComponentClause &clause) const {
  return !recovering_ && clause.prefixSpan.begin == clause.prefixSpan.end &&
         atAny({TokenKind::Equal, TokenKind::LeftParenthesis, TokenKind::EqualEqual, TokenKind::Plus, TokenKind::Minus, TokenKind::Times,
                TokenKind::Divide, TokenKind::Assign});
}

void Parser::parseComponents(ast::ComponentClause &clause, bool single) {
  auto components = list<ast::Component>();
  components.push(parseComponent(clause, single));
  while (!single && accept(TokenKind::Comma))
    components.push(parseComponent(clause, single));
  clause.components = components.finish(arena_);
}

ast::Component Parser::parseComponent(const ast::ComponentClause &clause, bool single) {
  ast::Component component;
  const std::uint32_t begin = here();
  if (at(TokenKind::Identifier) || clause.type.parts.empty())
    component.name = parseName("the name of a component");
  else
    component.name = parseName(fmt::format("the name of a component of class '{}'", clause.type.parts[0].name.text));
  if (at(TokenKind::LeftBracket)) {
    component.hasSubscripts = true;
    component.subscripts = parseSubscripts();
  }
  component.modification = parseModification();
  if (clause.isCoordinate && component.modification != nullptr && component.modification->value != nullptr)
    complain(CoordinateBinding, component.modification->value->span, component.name.text);
  if (!single && accept(TokenKind::If))
    component.condition = parseBracketed();
  component.comment = parseComment();
  component.span = since(begin);
  return component;
}

// `constrainedby` after a component clause or a class; outside of modifications with a description.
template <class Constrained> void Parser::parseConstraining(Constrained &node, bool isReplaceable, bool withComment) {
  if (!at(TokenKind::Constrainedby))
    return;
  if (!isReplaceable)
    complain(ConstrainedNotReplaceable, span(current()));
  advance();
  node.hasConstraint = true;
  node.constraint = parseTypeName("the name of a class");
  if (at(TokenKind::LeftParenthesis))
    node.constraintModification = parseClassModification();
  if (withComment)
    node.constraintComment = parseComment();
}

template void Parser::parseConstraining(ast::ComponentClause &, bool, bool);
template void Parser::parseConstraining(ast::ClassDefinition &, bool, bool);

}  // namespace tf::syntax
