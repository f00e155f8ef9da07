// Modifications, descriptions and annotations (MLS A.2.5, A.2.7).
#include "lang/syntax/parser_core.h"

namespace tf::syntax {

using ast::ArgumentKind;

ast::Modification *Parser::parseModification() {
  ast::Modification *modification = nullptr;
  const std::uint32_t begin = here();
  if (at(TokenKind::LeftParenthesis))
    modification = parseClassModification();
  if (!atAny({TokenKind::Equal, TokenKind::Assign}))
    return modification;
  if (modification == nullptr)
    modification = arena_.make<ast::Modification>();
  parseModificationValue(*modification);
  modification->span = since(begin);
  return modification;
}

void Parser::parseModificationValue(ast::Modification &modification) {
  modification.isAssignment = at(TokenKind::Assign);
  advance();
  if (accept(TokenKind::Break))
    modification.isBreak = true;
  else
    modification.value = parseBracketed();
}

ast::Modification *Parser::parseClassModification(bool inExtends) {
  auto *modification = arena_.make<ast::Modification>();
  modification->hasArguments = true;
  const Token &opening = current();
  const Nesting nesting(*this);
  if (nesting.tooDeep())
    return modification;
  advance();
  auto arguments = list<ast::Argument>();
  if (!at(TokenKind::RightParenthesis)) {
    do {
      arguments.push(parseArgument(inExtends));
    } while (acceptSeparator(TokenKind::RightParenthesis));
  }
  expectClosing(TokenKind::RightParenthesis, opening);
  modification->arguments = arguments.finish(arena_);
  modification->span = since(opening.begin);
  return modification;
}

ast::Argument Parser::parseArgument(bool inExtends) {
  ast::Argument argument;
  const std::uint32_t begin = here();
  if (at(TokenKind::Break)) {
    if (!inExtends)
      complain(BreakOutsideExtends, span(current()));
    parseBreakArgument(argument);
    argument.span = since(begin);
    return argument;
  }
  argument.isRedeclare = accept(TokenKind::Redeclare);
  argument.isEach = accept(TokenKind::Each);
  argument.isFinal = accept(TokenKind::Final);
  if (at(TokenKind::Each) && !argument.isEach) {
    complain(PrefixOrder, span(current()), "each", "final");
    argument.isEach = accept(TokenKind::Each);
  }
  argument.isReplaceable = accept(TokenKind::Replaceable);
  if (argument.isRedeclare || argument.isReplaceable)
    parseRedeclaration(argument);
  else
    parseElementArgument(argument);
  argument.span = since(begin);
  return argument;
}

void Parser::parseBreakArgument(ast::Argument &argument) {
  advance();
  if (at(TokenKind::Connect)) {
    argument.kind = ArgumentKind::BreakConnect;
    argument.connect = parseConnect();
    return;
  }
  argument.kind = ArgumentKind::BreakComponent;
  ast::ReferencePart part;
  const std::uint32_t begin = here();
  part.name = parseName("the name of a component or 'connect'");
  auto parts = list<ast::ReferencePart>();
  parts.push(part);
  argument.path = {false, parts.finish(arena_), since(begin)};
}

void Parser::parseElementArgument(ast::Argument &argument) {
  if (at(TokenKind::Der)) {
    argument.kind = ArgumentKind::Der;
    const Token &der = current();
    advance();
    if (at(TokenKind::LeftParenthesis))
      argument.modification = parseClassModification();
    else
      fail(DerModifier, span(der));
    argument.comment = parseDescription();
    return;
  }
  argument.path = parseTypeName("a modification 'name = value' or 'name(…)'");
  argument.modification = parseModification();
  argument.comment = parseDescription();
}

void Parser::parseRedeclaration(ast::Argument &argument) {
  if (atClass()) {
    argument.kind = ArgumentKind::RedeclareClass;
    argument.classDefinition = parseClass(true);
    parseConstraining(*argument.classDefinition, argument.isReplaceable, false);
    return;
  }
  argument.kind = ArgumentKind::RedeclareComponent;
  argument.component = parseComponentClause(true);
  parseConstraining(*argument.component, argument.isReplaceable, false);
}

ast::Comment Parser::parseDescription() {
  ast::Comment comment;
  if (!at(TokenKind::String))
    return comment;
  const std::uint32_t begin = here();
  auto strings = list<std::string_view>();
  do {
    if (!at(TokenKind::String)) {
      unexpected("a string");
      break;
    }
    strings.push(text(current()));
    advance();
  } while (accept(TokenKind::Plus));
  comment.strings = strings.finish(arena_);
  comment.span = since(begin);
  return comment;
}

ast::Comment Parser::parseComment() {
  const std::uint32_t begin = here();
  ast::Comment comment = parseDescription();
  if (at(TokenKind::Annotation)) {
    comment.annotation = parseAnnotation();
    comment.span = since(begin);
  }
  return comment;
}

ast::Modification *Parser::parseAnnotation() {
  advance();
  if (at(TokenKind::LeftParenthesis))
    return parseClassModification();
  expect(TokenKind::LeftParenthesis);
  return nullptr;
}

}  // namespace tf::syntax
