// Equation, algorithm and constraint sections (MLS A.2.6; language reference, chapter 5).
#include "lang/syntax/parser_core.h"

#include <fmt/format.h>

namespace tf::syntax {

namespace {

using ast::EquationKind;
using ast::ExprKind;
using ast::Operator;
using ast::SectionKind;
using ast::StatementKind;

bool isRelation(Operator op) { return op >= Operator::Less && op <= Operator::NotEqual; }

// A name, or a subscripted one: what can be assigned to.
bool isVariable(const ast::Expr &expression) { return expression.kind == ExprKind::Reference || expression.kind == ExprKind::Error; }

}  // namespace

// ---- sections --------------------------------------------------------------------------------------------------------------------

bool Parser::atConstraintSection() const {
  return enclosing_ == ast::Restriction::Optimization && (atWord("constraint") || (at(TokenKind::Identifier) && position_ == assumedWord_));
}

bool Parser::atSection() const {
  return at(TokenKind::Equation) || at(TokenKind::Algorithm) || atConstraintSection() ||
         (at(TokenKind::Initial) && (peek(1).kind == TokenKind::Equation || peek(1).kind == TokenKind::Algorithm));
}

ast::Section Parser::parseSection() {
  ast::Section section;
  const std::uint32_t begin = here();
  const bool isInitial = accept(TokenKind::Initial);
  inConstraints_ = atConstraintSection();
  const bool isAlgorithm = at(TokenKind::Algorithm);
  section.kind = inConstraints_ ? SectionKind::Constraint
                 : isAlgorithm  ? (isInitial ? SectionKind::InitialAlgorithm : SectionKind::Algorithm)
                                : (isInitial ? SectionKind::InitialEquation : SectionKind::Equation);
  advance();
  if (isAlgorithm)
    section.statements = parseStatements();
  else
    section.equations = parseEquations();
  inConstraints_ = false;
  section.span = since(begin);
  return section;
}

// One equation or statement among the declarations, as a section; reported once for a class.
ast::Section Parser::parseStraySection() {
  ast::Section section;
  const std::uint32_t begin = here();
  std::size_t ahead = 0;
  while (peek(ahead).kind == TokenKind::Identifier || peek(ahead).kind == TokenKind::Dot)
    ++ahead;
  const bool isStatement = enclosing_ == ast::Restriction::Function || enclosing_ == ast::Restriction::OperatorFunction ||
                           peek(ahead).kind == TokenKind::Assign || at(TokenKind::While);
  if (!std::exchange(equationReported_, true)) {
    const Span what = cover(span(current()), span(peek(ahead > 0 ? ahead - 1 : 0)));
    auto &diagnostic =
        complain(EquationOutsideSection, what, isStatement ? "a statement" : "an equation", isStatement ? "algorithm" : "equation");
    // gravity(acceleration = …)
    if (ahead > 0 && peek(ahead).kind == TokenKind::LeftParenthesis && peek(ahead + 1).kind == TokenKind::Identifier &&
        peek(ahead + 2).kind == TokenKind::Equal)
      diagnostic.note(what, fmt::format("a component has a name of its own: '{} name(...)'", text(peek(ahead - 1))));
  }
  if (isStatement) {
    section.kind = SectionKind::Algorithm;
    auto statements = list<ast::Statement *>();
    statements.push(parseStatement());
    section.statements = statements.finish(arena_);
  } else {
    auto equations = list<ast::Equation *>();
    equations.push(parseEquation());
    section.equations = equations.finish(arena_);
  }
  expectSemicolon();
  section.span = since(begin);
  return section;
}

// Where the equations or statements of a section or block end. Declarations do not end them: they are an error there.
bool Parser::atEndOfBody() const {
  switch (current().kind) {
  case TokenKind::EndOfFile:
  case TokenKind::End:
  case TokenKind::Public:
  case TokenKind::Protected:
  case TokenKind::External:
  case TokenKind::Annotation:
    return true;
  case TokenKind::Else:
  case TokenKind::Elseif:
  case TokenKind::Elsewhen:
    return !openBlocks_.empty();
  default:
    return atSection();
  }
}

template <class Body> ast::List<Body *> Parser::parseBody() {
  auto bodies = list<Body *>();
  while (!atEndOfBody() && !atGluedEnd() && !atMisspelledElseif()) {
    const std::size_t start = itemStart_ = position_;
    if constexpr (std::is_same_v<Body, ast::Equation>)
      bodies.push(parseEquation());
    else
      bodies.push(parseStatement());
    expectSemicolon();
    if (recovering_)
      synchronize();
    if (position_ == start)
      advance();
  }
  return bodies.finish(arena_);
}

ast::List<ast::Equation *> Parser::parseEquations() { return parseBody<ast::Equation>(); }
ast::List<ast::Statement *> Parser::parseStatements() { return parseBody<ast::Statement>(); }

// ---- blocks ----------------------------------------------------------------------------------------------------------------------

// `then` or `loop`. A broken head of a block does not take the block with it.
void Parser::expectHeadWord(TokenKind word) {
  if (accept(word))
    return;
  const bool isComplete = !recovering_ && current().startsLine;
  unexpected(fmt::format("'{}'", spelling(word)));
  while (!isComplete && !isStructural(current(), 0) && current().kind != word && current().kind != TokenKind::Semicolon)
    ++position_;
  resume();
  if (!isComplete && !accept(word))
    accept(TokenKind::Semicolon);
}

template <class Body> ast::Branch<Body> Parser::parseConditionalBranch() {
  ast::Branch<Body> branch;
  advance();
  branch.condition = parseBracketed();
  expectHeadWord(TokenKind::Then);
  branch.body = parseBody<Body>();
  return branch;
}

template <class Body> void Parser::parseIfBlock(Body &block) {
  const Token &opening = current();
  auto branches = list<ast::Branch<Body>>();
  openBlocks_.push_back(TokenKind::If);
  do {
    branches.push(parseConditionalBranch<Body>());
  } while (at(TokenKind::Elseif));
  const Token *elseIf = nullptr;
  if (accept(TokenKind::Else)) {
    elseIf = at(TokenKind::If) && !current().startsLine ? &current() : nullptr;
    ast::Branch<Body> branch;
    branch.body = parseBody<Body>();
    branches.push(branch);
  }
  openBlocks_.pop_back();
  expectEndOf(TokenKind::If, opening, elseIf);
  block.branches = branches.finish(arena_);
}

template <class Body> void Parser::parseWhenBlock(Body &block) {
  const Token &opening = current();
  auto branches = list<ast::Branch<Body>>();
  openBlocks_.push_back(TokenKind::When);
  do {
    branches.push(parseConditionalBranch<Body>());
  } while (at(TokenKind::Elsewhen));
  openBlocks_.pop_back();
  expectEndOf(TokenKind::When, opening);
  block.branches = branches.finish(arena_);
}

template <class Body> void Parser::parseForBlock(Body &block) {
  const Token &opening = current();
  advance();
  block.iterators = parseForIndices();
  expectHeadWord(TokenKind::Loop);
  openBlocks_.push_back(TokenKind::For);
  block.body = parseBody<Body>();
  openBlocks_.pop_back();
  expectEndOf(TokenKind::For, opening);
}

// `end if` and the like. An end that closes something further out is left to it.
void Parser::expectEndOf(TokenKind block, const Token &opening, const Token *elseIf) {
  if (recovering_)
    return;
  const std::string_view word = spelling(block);
  const std::string wanted = fmt::format("end {}", word);
  const Token &end = current();
  const Token &written = peek(1);
  if (end.kind == TokenKind::End && written.kind == block) {
    advance();
    advance();
    return;
  }
  if (at(TokenKind::Identifier) && text(end).starts_with("end") && text(end).substr(3) == word) {
    complain(UnexpectedToken, span(end), fmt::format("'{}'", wanted), describe(end));
    advance();
    return;
  }
  const bool closesBlock = written.kind == TokenKind::If || written.kind == TokenKind::For || written.kind == TokenKind::When ||
                           written.kind == TokenKind::While;
  const bool closesOuter = std::find(openBlocks_.begin(), openBlocks_.end(), written.kind) != openBlocks_.end();
  if (end.kind == TokenKind::End && closesBlock && !closesOuter) {
    complain(MismatchedEnd, span(written), text(written), word, word).note(span(opening), fmt::format("'{}' begins here", word));
    advance();
    advance();
    return;
  }
  if (end.kind == TokenKind::End && (written.kind == TokenKind::Semicolon || written.startsLine)) {
    const Token &got = written.startsLine ? end : written;
    complain(UnexpectedToken, span(got), fmt::format("'{}'", wanted), describe(got));
    advance();
    endMissing_ = written.startsLine;
    return;
  }
  endReported_ = endReported_ || end.kind == TokenKind::EndOfFile;
  Diagnostic &missing = fail(MissingEnd, span(opening), word, wanted);
  missing.note(span(end), fmt::format("it would stand before {}", describe(end)));
  if (elseIf != nullptr)
    missing.note(span(*elseIf), "'else if' begins a second 'if' here; 'elseif' would continue the first");
}

// ---- equations -------------------------------------------------------------------------------------------------------------------

ast::Equation *Parser::parseEquation() {
  auto *equation = arena_.make<ast::Equation>();
  const std::size_t start = position_;
  const std::uint32_t begin = here();
  const Nesting nesting(*this);
  if (nesting.tooDeep())
    return equation;
  if (inConstraints_ && (at(TokenKind::When) || at(TokenKind::Connect)))
    complain(InvalidConstraint, span(current()), text(current()));
  if (at(TokenKind::If)) {
    equation->kind = EquationKind::If;
    parseIfBlock(*equation);
  } else if (at(TokenKind::For)) {
    equation->kind = EquationKind::For;
    parseForBlock(*equation);
  } else if (at(TokenKind::When)) {
    equation->kind = EquationKind::When;
    parseWhenBlock(*equation);
  } else if (at(TokenKind::Connect)) {
    equation = parseConnect();
  } else if (!rejectForeignEquation() && !rejectDeclaration(inConstraints_ ? "constraint" : "equation")) {
    equation = inConstraints_ ? parseConstraintRelation(equation) : parseEqualityOrCall(equation, start);
  }
  equation->comment = parseComment();
  equation->span = since(begin);
  return equation;
}

// Statements among equations are read, reported and dropped.
bool Parser::rejectForeignEquation() {
  if (!atAny({TokenKind::While, TokenKind::Break, TokenKind::Return}))
    return false;
  complain(StatementInEquations, span(current()), text(current()));
  parseStatement();
  return true;
}

// A declaration behind `equation` or `algorithm` is read, reported and dropped.
bool Parser::rejectDeclaration(std::string_view section) {
  const bool isDeclared =
      atDeclarationPrefix() || (at(TokenKind::Identifier) && peek(1).kind == TokenKind::Identifier && !peek(1).startsLine);
  if (!isDeclared || atAny({TokenKind::Pure}))
    return false;
  complain(DeclarationInSection, span(current()), section);
  const std::vector<TokenKind> openBlocks = std::exchange(openBlocks_, {});
  parseElement(false);
  openBlocks_ = openBlocks;
  return true;
}

ast::Equation *Parser::parseEqualityOrCall(ast::Equation *equation, std::size_t start) {
  equation->left = parseSimple();
  if (recovering_)
    return equation;
  if (at(TokenKind::Identifier) && !current().startsLine && equation->left->kind == ExprKind::Reference) {
    // `Modelica.Units.SI.Angle phi;`
    rewind(start);
    complain(DeclarationInSection, equation->left->span, "equation");
    parseElement(false);
    equation->left = nullptr;
    return equation;
  }
  if (at(TokenKind::Equal) || at(TokenKind::Assign)) {
    if (at(TokenKind::Assign))
      complain(AssignInEquation, span(current()));
    equation->kind = EquationKind::Equality;
    advance();
    equation->right = parseBracketed();
  } else if (equation->left->kind == ExprKind::Binary && equation->left->op == Operator::Equal) {
    complain(ComparisonAsEquation, equation->left->operatorSpan);
    equation->kind = EquationKind::Equality;
    equation->right = equation->left->operands[1];
    equation->left = equation->left->operands[0];
  } else if (equation->left->kind == ExprKind::Call) {
    equation->kind = EquationKind::Call;
    equation->call = equation->left;
    equation->left = nullptr;
  } else {
    fail(IncompleteEquation, equation->left->span);
  }
  return equation;
}

// `a = b`, `a == b`, `a <= b` in a constraint section.
ast::Equation *Parser::parseConstraintRelation(ast::Equation *equation) {
  ast::Expr *left = parseSimple();
  equation->left = left;
  if (recovering_)
    return equation;
  equation->kind = EquationKind::Constraint;
  if (at(TokenKind::Equal)) {
    equation->op = Operator::Equal;
    advance();
    equation->right = parseBracketed();
  } else if (left->kind == ExprKind::Binary && isRelation(left->op) && left->op != Operator::NotEqual) {
    equation->op = left->op;
    equation->left = left->operands[0];
    equation->right = left->operands[1];
  } else {
    equation->kind = EquationKind::Error;
    fail(ConstraintNeedsRelation, left->span);
  }
  return equation;
}

ast::Equation *Parser::parseConnect() {
  auto *equation = arena_.make<ast::Equation>();
  const std::uint32_t begin = here();
  equation->kind = EquationKind::Connect;
  advance();
  const Token &opening = current();
  expect(TokenKind::LeftParenthesis);
  const auto parseConnector = [&] {
    ast::Expr *connector = parseExpression();
    if (connector->kind != ExprKind::Reference && connector->kind != ExprKind::Error)
      complain(ConnectArgument, connector->span);
    return connector;
  };
  equation->left = parseConnector();
  const bool isAlone = at(TokenKind::RightParenthesis);
  if (!isAlone && expect(TokenKind::Comma))
    equation->right = parseConnector();
  expectClosing(TokenKind::RightParenthesis, opening);
  equation->span = since(begin);
  if (isAlone)
    complain(ConnectArgument, equation->span);
  return equation;
}

// ---- statements ------------------------------------------------------------------------------------------------------------------

ast::Statement *Parser::parseStatement() {
  auto *statement = arena_.make<ast::Statement>();
  const std::size_t start = position_;
  const Token &first = current();
  const Nesting nesting(*this);
  if (nesting.tooDeep())
    return statement;
  if (at(TokenKind::If)) {
    statement->kind = StatementKind::If;
    parseIfBlock(*statement);
  } else if (at(TokenKind::For)) {
    statement->kind = StatementKind::For;
    parseForBlock(*statement);
  } else if (at(TokenKind::When)) {
    statement->kind = StatementKind::When;
    parseWhenBlock(*statement);
  } else if (at(TokenKind::While)) {
    parseWhile(*statement);
  } else if (accept(TokenKind::Break)) {
    statement->kind = StatementKind::Break;
  } else if (accept(TokenKind::Return)) {
    statement->kind = StatementKind::Return;
  } else if (at(TokenKind::Connect)) {
    complain(EquationInAlgorithm, span(first), text(first));
    parseConnect();
  } else if (!rejectDeclaration("algorithm")) {
    statement = parseAssignmentOrCall(statement, start);
  }
  statement->comment = parseComment();
  statement->span = since(first.begin);
  return statement;
}

void Parser::parseWhile(ast::Statement &statement) {
  const Token &opening = current();
  statement.kind = StatementKind::While;
  openBlocks_.push_back(TokenKind::While);
  advance();
  statement.condition = parseBracketed();
  expectHeadWord(TokenKind::Loop);
  statement.body = parseStatements();
  openBlocks_.pop_back();
  expectEndOf(TokenKind::While, opening);
}

void Parser::parseAssignmentTarget(ast::Statement &statement, ast::Expr *target) {
  statement.left = target;
  statement.kind = target->kind == ExprKind::Tuple ? StatementKind::MultiAssignment : StatementKind::Assignment;
  if (target->kind == ExprKind::Tuple) {
    for (const ast::Expr *element : target->operands) {
      if (element != nullptr && !isVariable(*element))
        complain(InvalidTarget, element->span);
    }
  } else if (!isVariable(*target)) {
    complain(InvalidTarget, target->span);
  }
}

ast::Statement *Parser::parseAssignmentOrCall(ast::Statement *statement, std::size_t start) {
  ast::Expr *left = parsePrimary();
  if (recovering_)
    return statement;
  if (at(TokenKind::Identifier) && !current().startsLine && left->kind == ExprKind::Reference) {
    rewind(start);
    complain(DeclarationInSection, left->span, "algorithm");
    parseElement(false);
    return statement;
  }
  if (at(TokenKind::Assign) || at(TokenKind::Equal)) {
    if (at(TokenKind::Equal))
      complain(EqualInStatement, span(current()));
    parseAssignmentTarget(*statement, left);
    advance();
    statement->right = parseBracketed();
    if (statement->kind == StatementKind::MultiAssignment && statement->right->kind != ExprKind::Call &&
        statement->right->kind != ExprKind::Error)
      complain(MultipleNeedsCall, statement->right->span);
  } else if (left->kind == ExprKind::Call) {
    statement->kind = StatementKind::Call;
    statement->right = left;
  } else {
    fail(IncompleteStatement, errorSpan(), describe(current()));
  }
  return statement;
}

}  // namespace tf::syntax
