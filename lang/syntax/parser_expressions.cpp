// Expressions (MLS A.2.7), by precedence climbing.
#include "lang/syntax/parser_core.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace tf::syntax {

namespace {

using ast::ExprKind;
using ast::Operator;

// Levels of binding, weakest first.
enum Level : int { None = 0, OrLevel, AndLevel, NotLevel, RelationLevel, AddLevel, MultiplyLevel, PowerLevel };

struct BinaryOperator {
  int level = None;
  Operator op = Operator::None;
};

constexpr std::array<BinaryOperator, 256> makeBinaryOperators() {
  std::array<BinaryOperator, 256> table{};
  const auto set = [&](TokenKind kind, int level, Operator op) { table[static_cast<std::size_t>(kind)] = {level, op}; };
  set(TokenKind::Or, OrLevel, Operator::Or);
  set(TokenKind::And, AndLevel, Operator::And);
  set(TokenKind::Less, RelationLevel, Operator::Less);
  set(TokenKind::LessEqual, RelationLevel, Operator::LessEqual);
  set(TokenKind::Greater, RelationLevel, Operator::Greater);
  set(TokenKind::GreaterEqual, RelationLevel, Operator::GreaterEqual);
  set(TokenKind::EqualEqual, RelationLevel, Operator::Equal);
  set(TokenKind::NotEqual, RelationLevel, Operator::NotEqual);
  set(TokenKind::Plus, AddLevel, Operator::Plus);
  set(TokenKind::Minus, AddLevel, Operator::Minus);
  set(TokenKind::DotPlus, AddLevel, Operator::DotPlus);
  set(TokenKind::DotMinus, AddLevel, Operator::DotMinus);
  set(TokenKind::Times, MultiplyLevel, Operator::Times);
  set(TokenKind::Divide, MultiplyLevel, Operator::Divide);
  set(TokenKind::DotTimes, MultiplyLevel, Operator::DotTimes);
  set(TokenKind::DotDivide, MultiplyLevel, Operator::DotDivide);
  set(TokenKind::Power, PowerLevel, Operator::Power);
  set(TokenKind::DotPower, PowerLevel, Operator::DotPower);
  return table;
}

constexpr std::array<BinaryOperator, 256> binaryOperators = makeBinaryOperators();

BinaryOperator binaryOperator(TokenKind kind) { return binaryOperators[static_cast<std::size_t>(kind)]; }

}  // namespace

ast::Expr *Parser::newExpr(ExprKind kind, std::uint32_t begin) {
  auto *expression = arena_.make<ast::Expr>();
  expression->kind = kind;
  expression->span = {file_, begin, begin};
  return expression;
}

template <class... Exprs> ast::List<ast::Expr *> Parser::exprs(Exprs... elements) {
  constexpr std::size_t count = sizeof...(elements);
  auto **data = static_cast<ast::Expr **>(arena_.allocate(count * sizeof(ast::Expr *), alignof(ast::Expr *)));
  std::size_t i = 0;
  ((data[i++] = elements), ...);
  return {data, static_cast<std::uint32_t>(count)};
}

ast::Expr *Parser::finish(ast::Expr *expression) {
  int height = 0;
  const auto include = [&](const ast::Expr *child) { height = child != nullptr ? std::max<int>(height, child->height) : height; };
  for (const ast::Expr *child : expression->operands)
    include(child);
  for (const ast::NamedArgument &argument : expression->named)
    include(argument.value);
  for (const ast::ForIndex &index : expression->iterators)
    include(index.range);
  for (const ast::ReferencePart &part : expression->reference.parts)
    for (const ast::Expr *child : part.subscripts)
      include(child);
  expression->span = since(expression->span.begin);
  if (height < ast::maxExpressionHeight) {
    expression->height = static_cast<std::uint16_t>(height + 1);
    return expression;
  }
  fail(TooDeep, span(previous()), ast::maxExpressionHeight);
  ast::Expr *error = newExpr(ExprKind::Error, expression->span.begin);
  error->span = expression->span;
  return error;
}

ast::Expr *Parser::missingExpression() {
  const Token &token = current();
  if (at(TokenKind::End) && !token.startsLine) {
    advance();
    fail(EndOutsideSubscript, span(token));
  } else if (at(TokenKind::If)) {
    fail(MissingExpression, span(token), "'if'; an if-expression inside another needs parentheses");
  } else {
    fail(MissingExpression, errorSpan(), describe(token));
  }
  return newExpr(ExprKind::Error, token.begin);
}

ast::Expr *Parser::parseExpression() {
  const Nesting nesting(*this);
  if (nesting.tooDeep())
    return newExpr(ExprKind::Error, here());
  return at(TokenKind::If) ? parseIf() : parseSimple();
}

ast::Expr *Parser::parseBracketed() {
  ast::Expr *expression = parseExpression();
  while (atAny({TokenKind::Equal, TokenKind::Assign})) {
    const Token &token = current();
    complain(token.kind == TokenKind::Equal ? EqualInExpression : AssignInExpression, span(token));
    advance();
    expression = binary(Operator::Equal, token, expression, parseExpression());
  }
  return expression;
}

ast::Expr *Parser::parseIf() {
  ast::Expr *expression = newExpr(ExprKind::If, here());
  auto operands = list<ast::Expr *>();
  do {
    advance();
    operands.push(parseBracketed());
    expect(TokenKind::Then);
    operands.push(parseExpression());
  } while (at(TokenKind::Elseif));
  expect(TokenKind::Else);
  operands.push(parseExpression());
  expression->operands = operands.finish(arena_);
  return finish(expression);
}

ast::Expr *Parser::parseSimple() {
  const std::uint32_t begin = here();
  ast::Expr *first = parseOperators(OrLevel);
  if (!at(TokenKind::Colon))
    return first;
  ast::Expr *range = newExpr(ExprKind::Range, begin);
  advance();
  ast::Expr *second = parseOperators(OrLevel);
  range->operands = accept(TokenKind::Colon) ? exprs(first, second, parseOperators(OrLevel)) : exprs(first, second);
  return finish(range);
}

ast::Expr *Parser::binary(Operator op, const Token &token, ast::Expr *left, ast::Expr *right) {
  ast::Expr *expression = newExpr(ExprKind::Binary, left->span.begin);
  expression->op = op;
  expression->operatorSpan = span(token);
  expression->operands = exprs(left, right);
  return finish(expression);
}

// Operators of `minimumLevel` and stronger.
ast::Expr *Parser::parseOperators(int minimumLevel) {
  ast::Expr *left = nullptr;
  const Token &first = current();
  const bool isNot = at(TokenKind::Not) && minimumLevel <= NotLevel;
  const bool isSign = atAny({TokenKind::Plus, TokenKind::Minus, TokenKind::DotPlus, TokenKind::DotMinus});
  if (isNot || isSign) {
    const std::string_view operatorBefore = text(previous());
    advance();
    ast::Expr *unary = newExpr(ExprKind::Unary, first.begin);
    unary->op = isNot ? Operator::Not : binaryOperator(first.kind).op;
    unary->operatorSpan = span(first);
    unary->operands = exprs(parseOperators(isNot ? RelationLevel : std::max<int>(minimumLevel, MultiplyLevel)));
    left = finish(unary);
    if (isSign && minimumLevel > AddLevel)
      complain(SignAfterOperator, span(first), operatorBefore);
  } else {
    left = parsePrimary();
  }
  int previousLevel = None;
  while (true) {
    const BinaryOperator next = binaryOperator(kind_);
    if (next.level == None || next.level < minimumLevel)
      return left;
    const Token &token = current();
    if (next.level == previousLevel && (next.level == RelationLevel || next.level == PowerLevel))
      complain(next.level == RelationLevel ? ChainedRelation : ChainedPower, span(token), text(token));
    advance();
    left = binary(next.op, token, left, parseOperators(next.level + 1));
    previousLevel = next.level;
  }
}

ast::Expr *Parser::parsePrimary() {
  switch (kind_) {
  case TokenKind::Integer:
  case TokenKind::Real:
  case TokenKind::String:
  case TokenKind::True:
  case TokenKind::False:
    return parseLiteral();
  case TokenKind::Identifier:
  case TokenKind::Dot:
  case TokenKind::Der:
  case TokenKind::Initial:
  case TokenKind::Pure:
    return parseReferenceOrCall();
  case TokenKind::LeftParenthesis:
    return parseParenthesised();
  case TokenKind::LeftBracket:
    return parseMatrix();
  case TokenKind::LeftBrace:
    return parseArray();
  case TokenKind::End:
    if (subscripts_ > 0) {
      ast::Expr *end = newExpr(ExprKind::End, here());
      advance();
      return finish(end);
    }
    return missingExpression();
  default:
    return atClassWordAsName() ? parseReferenceOrCall() : missingExpression();
  }
}

ast::Expr *Parser::parseLiteral() {
  const Token &token = current();
  ast::Expr *literal = newExpr(ExprKind::String, token.begin);
  literal->text = text(token);
  if (at(TokenKind::True) || at(TokenKind::False)) {
    literal->kind = ExprKind::Boolean;
    literal->number = at(TokenKind::True) ? 1 : 0;
  } else if (!at(TokenKind::String)) {
    literal->kind = at(TokenKind::Integer) ? ExprKind::Integer : ExprKind::Real;
    const char *begin = literal->text.data();
    if (std::from_chars(begin, begin + literal->text.size(), literal->number).ec == std::errc::result_out_of_range) {
      // from_chars does not tell overflow from underflow.
      literal->number = std::strtod(std::string(literal->text).c_str(), nullptr);
      if (std::isinf(literal->number))
        complain(NumberOutOfRange, span(token), literal->text.substr(0, 40));
    }
  }
  advance();
  return finish(literal);
}

ast::Expr *Parser::parseReferenceOrCall() {
  ast::Expr *expression = newExpr(ExprKind::Reference, here());
  if (!atAny({TokenKind::Der, TokenKind::Initial, TokenKind::Pure})) {
    expression->reference = parseReference();
  } else {
    // der, initial and pure are keywords that are called.
    auto parts = list<ast::ReferencePart>();
    ast::ReferencePart part;
    part.name = {text(current()), span(current())};
    parts.push(part);
    expression->reference = {false, parts.finish(arena_), span(current())};
    advance();
    if (!at(TokenKind::LeftParenthesis)) {
      expect(TokenKind::LeftParenthesis);
      expression->kind = ExprKind::Error;
    }
  }
  if (!at(TokenKind::LeftParenthesis))
    return finish(expression);
  expression->kind = ExprKind::Call;
  parseCallArguments(*expression);
  return parsePostfix(finish(expression));
}

ast::Expr *Parser::parseWholeExpression() {
  ast::Expr *expression = parseBracketed();
  if (!recovering_ && current().kind != TokenKind::EndOfFile)
    complain(TrailingText, span(current()), describe(current()));
  return expression;
}

// `der(q)(finalTime)`: only in optimization classes a call has a value at a time.
ast::Expr *Parser::parsePostfix(ast::Expr *call) {
  if (!at(TokenKind::LeftParenthesis) || current().startsLine)
    return call;
  const Token &opening = current();
  if (enclosing_ != ast::Restriction::Optimization) {
    fail(NotCallable, span(opening));
    return call;
  }
  advance();
  ast::Expr *value = newExpr(ExprKind::ValueAt, call->span.begin);
  ast::Expr *time = parseBracketed();
  expectClosing(TokenKind::RightParenthesis, opening);
  value->operands = exprs(call, time);
  return finish(value);
}

ast::Expr *Parser::parseParenthesised() {
  const Token &opening = current();
  ast::Expr *tuple = newExpr(ExprKind::Tuple, opening.begin);
  advance();
  auto elements = list<ast::Expr *>();
  if (!at(TokenKind::RightParenthesis)) {
    do {
      elements.push(at(TokenKind::Comma) || at(TokenKind::RightParenthesis) ? nullptr : parseBracketed());
    } while (accept(TokenKind::Comma));
  }
  expectClosing(TokenKind::RightParenthesis, opening);
  tuple->operands = elements.finish(arena_);
  tuple = finish(tuple);
  if (!at(TokenKind::LeftBracket))
    return tuple;
  ast::Expr *subscripted = newExpr(ExprKind::Subscripted, opening.begin);
  auto operands = list<ast::Expr *>();
  operands.push(tuple);
  for (ast::Expr *subscript : parseSubscripts())
    operands.push(subscript);
  subscripted->operands = operands.finish(arena_);
  return finish(subscripted);
}

// `x = [1, 2;` and on the next line `y = …`: the bracket was forgotten.
bool Parser::atNextEquation(const Token &opening) {
  if (!current().startsLine || (peek(1).kind != TokenKind::Equal && peek(1).kind != TokenKind::Assign))
    return false;
  const Span end{file_, tokens_[position_ - 2].end, tokens_[position_ - 2].end};
  fail(MissingBracket, end, "]", "';'").note(span(opening), "it would close this '['");
  --position_;  // the ';' ends the equation
  return true;
}

ast::Expr *Parser::parseMatrixRow() {
  ast::Expr *row = newExpr(ExprKind::Tuple, here());
  auto elements = list<ast::Expr *>();
  do {
    elements.push(parseBracketed());
  } while (accept(TokenKind::Comma));
  row->operands = elements.finish(arena_);
  return finish(row);
}

ast::Expr *Parser::parseMatrix() {
  const Token &opening = current();
  ast::Expr *matrix = newExpr(ExprKind::Matrix, opening.begin);
  advance();
  ++matrices_;
  auto rows = list<ast::Expr *>();
  do {
    rows.push(parseMatrixRow());
  } while (accept(TokenKind::Semicolon) && !atNextEquation(opening));
  expectClosing(TokenKind::RightBracket, opening, "',', ';'");
  --matrices_;
  matrix->operands = rows.finish(arena_);
  return finish(matrix);
}

ast::Expr *Parser::parseArray() {
  const Token &opening = current();
  ast::Expr *array = newExpr(ExprKind::Array, opening.begin);
  advance();
  if (at(TokenKind::RightBrace)) {
    advance();
    complain(ArrayElementMissing, since(opening.begin));
    return finish(array);
  }
  auto elements = list<ast::Expr *>();
  elements.push(parseBracketed());
  if (accept(TokenKind::For)) {
    array->iterators = parseForIndices();
  } else {
    while (acceptSeparator(TokenKind::RightBrace))
      elements.push(parseBracketed());
  }
  expectClosing(TokenKind::RightBrace, opening);
  array->operands = elements.finish(arena_);
  return finish(array);
}

// `function f(a = 1)` as an argument.
ast::Expr *Parser::parsePartialFunction() {
  ast::Expr *partial = newExpr(ExprKind::PartialFunction, here());
  advance();
  partial->reference = parseTypeName("the name of a function");
  if (at(TokenKind::LeftParenthesis))
    parseCallArguments(*partial);
  else
    expect(TokenKind::LeftParenthesis);
  if (!partial->operands.empty())
    complain(UnexpectedToken, partial->operands[0]->span, "'name = value'", "a positional argument");
  return finish(partial);
}

ast::Expr *Parser::parseArgumentValue() { return at(TokenKind::Function) ? parsePartialFunction() : parseBracketed(); }

void Parser::parseCallArguments(ast::Expr &call) {
  const Token &opening = current();
  advance();
  if (accept(TokenKind::RightParenthesis))
    return;
  auto positional = list<ast::Expr *>();
  auto named = list<ast::NamedArgument>();
  do {
    if (at(TokenKind::Identifier) && peek(1).kind == TokenKind::Equal) {
      ast::NamedArgument argument;
      argument.name = parseName("a name");
      advance();
      argument.value = parseArgumentValue();
      named.push(argument);
      continue;
    }
    const std::uint32_t begin = here();
    positional.push(parseArgumentValue());
    if (!named.empty())
      complain(PositionalAfterNamed, since(begin));
    if (positional.size() == 1 && named.empty() && accept(TokenKind::For)) {
      call.iterators = parseForIndices();
      break;
    }
  } while (acceptSeparator(TokenKind::RightParenthesis));
  expectClosing(TokenKind::RightParenthesis, opening);
  call.operands = positional.finish(arena_);
  call.named = named.finish(arena_);
}

ast::List<ast::ForIndex> Parser::parseForIndices() {
  auto indices = list<ast::ForIndex>();
  do {
    ast::ForIndex index;
    index.name = parseName("the name of an iterator");
    if (accept(TokenKind::In))
      index.range = parseBracketed();
    indices.push(index);
  } while (accept(TokenKind::Comma));
  return indices.finish(arena_);
}

}  // namespace tf::syntax
