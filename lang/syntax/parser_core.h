// The recursive-descent parser, one method per production of lang/reference/grammar.ebnf.
//
// Errors: `fail` reports one and enters recovery, in which no token matches any more, nothing is consumed and further errors are silent,
// so that all productions return what they have; the loops over elements, equations and statements then skip to a place where reading can
// go on (`synchronize`). `complain` reports an error whose repair is obvious and goes on as if the repair were written.
#pragma once

#include "lang/syntax/arena.h"
#include "lang/syntax/lexer.h"
#include "lang/syntax/syntax_diagnostics.h"

#include <initializer_list>
#include <optional>
#include <string>
#include <tuple>

namespace tf::syntax {

class Parser {
public:
  Parser(const SourceManager &sources, FileId file, ast::Arena &arena, Diagnostics &diagnostics);

  ast::File *parseFile();
  // Errors behind this place would be consequences of one before.
  [[nodiscard]] std::uint32_t unreliableFrom() const { return unreliableFrom_; }
  ast::Expr *parseWholeExpression();

private:
  // ---- tokens
  [[nodiscard]] bool at(TokenKind kind) const { return kind_ == kind; }
  [[nodiscard]] bool atAny(std::initializer_list<TokenKind> kinds) const {
    return std::find(kinds.begin(), kinds.end(), kind_) != kinds.end();
  }
  [[nodiscard]] bool atWord(std::string_view word) const { return at(TokenKind::Identifier) && text(current()) == word; }
  [[nodiscard]] const Token &current() const { return tokens_[position_]; }
  [[nodiscard]] const Token &peek(std::size_t ahead) const { return tokens_[std::min(position_ + ahead, tokens_.size() - 1)]; }
  [[nodiscard]] const Token &previous() const { return tokens_[position_ > 0 ? position_ - 1 : 0]; }
  [[nodiscard]] std::string_view text(const Token &token) const { return source_.substr(token.begin, token.end - token.begin); }
  [[nodiscard]] Span span(const Token &token) const { return {file_, token.begin, token.end}; }
  [[nodiscard]] std::uint32_t here() const { return current().begin; }
  // From `begin` to the end of the last consumed token.
  [[nodiscard]] Span since(std::uint32_t begin) const { return {file_, begin, std::max(begin, previous().end)}; }
  [[nodiscard]] std::string describe(const Token &token) const;
  void advance();
  bool accept(TokenKind kind);
  void rewind(std::size_t position);

  // ---- errors
  template <class... Args> Diagnostic &complain(const DiagnosticKind &kind, Span where, const Args &...args) {
    const bool isConsequence = current().followsError || (itemStart_ <= position_ && tokens_[itemStart_].followsError);
    if (recovering_ || isConsequence || std::max(where.begin, here()) >= unreliableFrom_)
      return silent_ = Diagnostic{};
    return diagnostics_.report(kind, where, args...);
  }
  template <class... Args> Diagnostic &fail(const DiagnosticKind &kind, Span where, const Args &...args) {
    Diagnostic &diagnostic = complain(kind, where, args...);
    failedInMatrix_ = recovering_ ? failedInMatrix_ : matrices_ > 0;
    recovering_ = true;
    kind_ = recoveryKind;
    return diagnostic;
  }
  void resume();
  void synchronize();
  [[nodiscard]] bool isStructural(const Token &token, std::size_t ahead) const;
  [[nodiscard]] bool isInsideMatrix() const;
  [[nodiscard]] Span errorSpan() const;
  Diagnostic &unexpected(std::string_view expected);
  bool expect(TokenKind kind);
  void expectSemicolon();
  bool acceptSeparator(TokenKind closing);
  void expectClosing(TokenKind closing, const Token &opening, std::string_view separators = "','");
  [[nodiscard]] bool startsSomething(const Token &token) const;

  // Guards recursion: reports where the text nests too deeply.
  class Nesting {
  public:
    explicit Nesting(Parser &parser);
    ~Nesting() { --parser_.nesting_; }
    Nesting(const Nesting &) = delete;
    Nesting &operator=(const Nesting &) = delete;
    [[nodiscard]] bool tooDeep() const { return parser_.recovering_; }

  private:
    Parser &parser_;
  };

  // ---- names
  [[nodiscard]] bool atClassWordAsName() const;
  ast::Name parseName(std::string_view what);
  ast::Reference parseDotted(std::string_view what, bool withSubscripts);
  ast::Reference parseReference() { return parseDotted("a name", true); }
  ast::Reference parseTypeName(std::string_view what) { return parseDotted(what, false); }
  ast::List<ast::Expr *> parseSubscripts();

  // ---- expressions
  ast::Expr *parseExpression();
  ast::Expr *parseBracketed();  // an expression that must not be followed by '=' or ':='
  ast::Expr *parseIf();
  ast::Expr *parseSimple();
  ast::Expr *parseOperators(int minimumLevel);
  ast::Expr *parsePrimary();
  ast::Expr *parsePostfix(ast::Expr *call);
  ast::Expr *parseLiteral();
  ast::Expr *parseReferenceOrCall();
  ast::Expr *parseParenthesised();
  ast::Expr *parseMatrix();
  ast::Expr *parseMatrixRow();
  bool atNextEquation(const Token &opening);
  ast::Expr *parseArray();
  ast::Expr *parsePartialFunction();
  void parseCallArguments(ast::Expr &call);
  ast::Expr *parseArgumentValue();
  ast::List<ast::ForIndex> parseForIndices();
  ast::Expr *missingExpression();
  ast::Expr *newExpr(ast::ExprKind kind, std::uint32_t begin);
  ast::Expr *binary(ast::Operator op, const Token &token, ast::Expr *left, ast::Expr *right);
  // Sets span and height; an Error leaf if the tree got too high.
  ast::Expr *finish(ast::Expr *expression);
  template <class... Exprs> ast::List<ast::Expr *> exprs(Exprs... elements);

  // ---- modifications
  ast::Modification *parseModification();  // null if there is none
  ast::Modification *parseClassModification(bool inExtends = false);
  ast::Argument parseArgument(bool inExtends);
  void parseModificationValue(ast::Modification &modification);
  void parseElementArgument(ast::Argument &argument);
  void parseRedeclaration(ast::Argument &argument);
  void parseBreakArgument(ast::Argument &argument);
  ast::Comment parseDescription();       // strings only
  ast::Comment parseComment();           // strings and annotation
  ast::Modification *parseAnnotation();  // at `annotation`

  // ---- elements
  struct ElementPrefixes {
    bool isRedeclare = false, isFinal = false, isInner = false, isOuter = false, isReplaceable = false;
    std::optional<Token> first;
  };
  ast::Element parseElement(bool isProtected);
  ElementPrefixes parseElementPrefixes();
  ast::Import *parseImport();
  ast::Extends *parseExtends();
  ast::ComponentClause *parseComponentClause(bool single);
  void parseTypePrefix(ast::ComponentClause &clause);
  void parseComponents(ast::ComponentClause &clause, bool single);
  ast::Component parseComponent(const ast::ComponentClause &clause, bool single);
  template <class Constrained> void parseConstraining(Constrained &node, bool isReplaceable, bool withComment);
  [[nodiscard]] bool atCoordinatePrefix() const;
  [[nodiscard]] bool atDeclarationPrefix() const;
  [[nodiscard]] bool atEquationInElements(const ast::ComponentClause &clause) const;
  void failAtEquation();
  ast::Section parseStraySection();

  // ---- classes
  [[nodiscard]] bool atClass() const;
  [[nodiscard]] bool atOptimization() const;
  [[nodiscard]] bool atMisplacedOptimization() const;
  ast::ClassDefinition *parseClass(bool inModification = false);
  bool parseClassPrefixes(ast::ClassDefinition &definition);
  void parseLongClass(ast::ClassDefinition &definition);
  void parseShortClass(ast::ClassDefinition &definition);
  void parseEnumeration(ast::ClassDefinition &definition);
  void parseDerClass(ast::ClassDefinition &definition);
  void parseComposition(ast::ClassDefinition &definition);
  bool parseCompositionItem(ast::ClassDefinition &definition, ast::ListBuilder<ast::Element> &elements,
                            ast::ListBuilder<ast::Section> &sections, bool &isProtected);
  void parseExternal(ast::ClassDefinition &definition);
  void parseClassAnnotation(ast::ClassDefinition &definition);
  void parseEndOfClass(ast::ClassDefinition &definition);
  void skipBrokenHeading();
  void parseWithin(ast::File &file);
  void skipToClass();

  // ---- equations and statements
  ast::Section parseSection();
  ast::List<ast::Equation *> parseEquations();
  ast::List<ast::Statement *> parseStatements();
  ast::Equation *parseEquation();
  ast::Equation *parseEqualityOrCall(ast::Equation *equation, std::size_t start);
  ast::Equation *parseConstraintRelation(ast::Equation *equation);
  ast::Equation *parseConnect();
  ast::Statement *parseStatement();
  void parseWhile(ast::Statement &statement);
  ast::Statement *parseAssignmentOrCall(ast::Statement *statement, std::size_t start);
  void parseAssignmentTarget(ast::Statement &statement, ast::Expr *target);
  bool rejectForeignEquation();
  bool rejectDeclaration(std::string_view section);
  template <class Body> void parseIfBlock(Body &block);
  template <class Body> void parseWhenBlock(Body &block);
  template <class Body> void parseForBlock(Body &block);
  template <class Body> ast::List<Body *> parseBody();
  template <class Body> ast::Branch<Body> parseConditionalBranch();
  void expectHeadWord(TokenKind word);
  void expectEndOf(TokenKind block, const Token &opening, const Token *elseIf = nullptr);
  [[nodiscard]] bool atEndOfBody() const;
  [[nodiscard]] bool atSection() const;
  [[nodiscard]] bool atConstraintSection() const;

  // ---- misspellings
  void replaceWord(TokenKind kind);
  [[nodiscard]] bool typeAndNameFollow(std::size_t ahead, bool onOneLine) const;
  void repairMisspelledPrefix();
  void repairMisspelledClass();
  bool parseMisspelledSection(ast::ListBuilder<ast::Section> &sections, bool &isProtected);
  bool atMisspelledElseif();
  [[nodiscard]] bool atGluedEnd() const;

  // Matches no token.
  static constexpr auto recoveryKind = static_cast<TokenKind>(255);

  FileId file_;
  std::string_view source_;
  ast::Arena &arena_;
  Diagnostics &diagnostics_;
  std::vector<Token> tokens_;
  std::vector<Span> comments_;
  std::uint32_t unreliableFrom_;
  std::size_t position_ = 0;
  std::size_t assumedWord_ = SIZE_MAX;     // position of a misspelled `coordinate` or `constraint`
  std::size_t itemStart_ = 0;              // position of the first token of the element, equation or statement that is read
  TokenKind kind_ = TokenKind::EndOfFile;  // of the current token; in recovery recoveryKind
  bool recovering_ = false;
  bool failedInMatrix_ = false;    // where recovery was entered
  bool foundEquation_ = false;     // recovery was entered at an equation among the declarations
  bool equationReported_ = false;  // one such report is enough for a class
  bool endMissing_ = false;        // the last class has no end, so no ';' either
  bool endReported_ = false;       // that the file ends inside a class or block: what is around it has no end either
  Diagnostic silent_;

  int nesting_ = 0;
  int subscripts_ = 0;  // `end` is an expression inside
  int matrices_ = 0;
  ast::Restriction enclosing_ = ast::Restriction::Package;  // of the class whose elements are read; Package at top level
  bool inConstraints_ = false;                              // in a constraint section
  std::vector<std::string_view> openClasses_;
  std::vector<TokenKind> openBlocks_;

  // Stacks of the list builders.
  template <class T> std::vector<T> &stack() { return std::get<std::vector<T>>(stacks_); }
  template <class T> ast::ListBuilder<T> list() { return ast::ListBuilder<T>(stack<T>()); }
  std::tuple<std::vector<ast::Expr *>, std::vector<ast::NamedArgument>, std::vector<ast::ForIndex>, std::vector<ast::ReferencePart>,
             std::vector<ast::Argument>, std::vector<ast::Component>, std::vector<ast::Name>, std::vector<std::string_view>,
             std::vector<ast::Element>, std::vector<ast::Section>, std::vector<ast::Equation *>, std::vector<ast::Statement *>,
             std::vector<ast::Branch<ast::Equation>>, std::vector<ast::Branch<ast::Statement>>, std::vector<ast::EnumerationLiteral>,
             std::vector<ast::ClassDefinition *>, std::vector<Span>>
      stacks_;
};

}  // namespace tf::syntax
