// Classes, elements, equations and statements as text.
#include "lang/syntax/parser.h"
#include "lang/syntax/printer.h"

namespace tf::ast {

namespace {

std::string_view restrictionText(Restriction restriction) {
  switch (restriction) {
  case Restriction::Class:
    return "class";
  case Restriction::Model:
    return "model";
  case Restriction::Record:
    return "record";
  case Restriction::Block:
    return "block";
  case Restriction::Connector:
    return "connector";
  case Restriction::Type:
    return "type";
  case Restriction::Package:
    return "package";
  case Restriction::Function:
    return "function";
  case Restriction::OperatorFunction:
    return "operator function";
  case Restriction::Operator:
    return "operator";
  case Restriction::OperatorRecord:
    return "operator record";
  case Restriction::Optimization:
    return "optimization";
  }
  return "";
}

std::string_view sectionText(SectionKind kind) {
  switch (kind) {
  case SectionKind::Equation:
    return "equation";
  case SectionKind::InitialEquation:
    return "initial equation";
  case SectionKind::Algorithm:
    return "algorithm";
  case SectionKind::InitialAlgorithm:
    return "initial algorithm";
  case SectionKind::Constraint:
    return "constraint";
  }
  return "";
}

std::string_view relationText(Operator op) {
  switch (op) {
  case Operator::Less:
    return " < ";
  case Operator::LessEqual:
    return " <= ";
  case Operator::Greater:
    return " > ";
  case Operator::GreaterEqual:
    return " >= ";
  default:
    return " = ";
  }
}

}  // namespace

// ---- classes ---------------------------------------------------------------------------------------------------------------------

void Printer::file(const File &file) {
  if (file.hasWithin) {
    write(file.within.parts.empty() ? "within" : "within ");
    reference(file.within);
    write(";\n");
  }
  for (const ClassDefinition *definition : file.classes) {
    if (definition->isFinal)
      write("final ");
    classDefinition(*definition);
    write(";\n");
  }
}

void Printer::heading(const ClassDefinition &definition) {
  if (definition.isEncapsulated)
    write("encapsulated ");
  if (definition.isPartial)
    write("partial ");
  if (definition.isPure)
    write("pure ");
  if (definition.isImpure)
    write("impure ");
  if (definition.isExpandable)
    write("expandable ");
  write(restrictionText(definition.restriction));
  write(definition.form == ClassForm::LongExtends ? " extends " : " ");
  write(definition.name.text);
}

void Printer::classDefinition(const ClassDefinition &definition) {
  heading(definition);
  if (definition.form == ClassForm::Long || definition.form == ClassForm::LongExtends) {
    if (definition.modification != nullptr)
      classModification(*definition.modification);
    comment(definition.comment);
    body(definition);
  } else {
    shortClass(definition);
    comment(definition.comment);
  }
  constraining(definition);
}

void Printer::shortClass(const ClassDefinition &definition) {
  write(" = ");
  if (definition.form == ClassForm::Enumeration) {
    write("enumeration(");
    if (definition.isOpenEnumeration)
      write(":");
    separated(definition.literals, [&](const EnumerationLiteral &literal) {
      write(literal.name.text);
      comment(literal.comment);
    });
    return write(")");
  }
  if (definition.form == ClassForm::Der) {
    write("der(");
    reference(definition.base);
    for (const Name &name : definition.derivativeVariables) {
      write(", ");
      write(name.text);
    }
    return write(")");
  }
  if (definition.causality != Causality::None)
    write(definition.causality == Causality::Input ? "input " : "output ");
  reference(definition.base);
  if (definition.hasSubscripts)
    subscripts(definition.subscripts);
  modification(definition.modification);
}

void Printer::body(const ClassDefinition &definition) {
  bool isProtected = false;
  ++indent_;
  for (const Element &each : definition.elements) {
    if (each.isProtected != isProtected) {
      isProtected = each.isProtected;
      --indent_;
      line();
      write(isProtected ? "protected" : "public");
      ++indent_;
    }
    line();
    element(each);
    write(";");
  }
  --indent_;
  for (const Section &each : definition.sections)
    section(each);
  if (definition.external != nullptr)
    external(*definition.external);
  if (definition.annotation != nullptr) {
    ++indent_;
    line();
    annotation(definition.annotation);
    write(";");
    --indent_;
  }
  line();
  write("end ");
  write(definition.name.text);
}

void Printer::external(const External &external) {
  line();
  write("external");
  if (!external.language.empty()) {
    write(" ");
    write(external.language);
  }
  if (external.hasOutput) {
    write(" ");
    reference(external.output);
    write(" =");
  }
  if (!external.function.text.empty()) {
    write(" ");
    write(external.function.text);
    write("(");
    separated(external.arguments, [&](const Expr *argument) { expression(*argument); });
    write(")");
  }
  if (external.annotation != nullptr) {
    write(" ");
    annotation(external.annotation);
  }
  write(";");
}

// ---- elements --------------------------------------------------------------------------------------------------------------------

template <class Constrained> void Printer::constraining(const Constrained &node) {
  if (!node.hasConstraint)
    return;
  write(" constrainedby ");
  reference(node.constraint);
  modification(node.constraintModification);
  comment(node.constraintComment);
}

void Printer::element(const Element &element) {
  if (element.isRedeclare)
    write("redeclare ");
  if (element.isFinal)
    write("final ");
  if (element.isInner)
    write("inner ");
  if (element.isOuter)
    write("outer ");
  if (element.isReplaceable)
    write("replaceable ");
  if (element.import != nullptr)
    import(*element.import);
  else if (element.extends != nullptr)
    extends(*element.extends);
  else if (element.classDefinition != nullptr)
    classDefinition(*element.classDefinition);
  else if (element.component != nullptr)
    componentClause(*element.component);
}

void Printer::import(const Import &import) {
  write("import ");
  if (import.kind == ImportKind::Renaming) {
    write(import.alias.text);
    write(" = ");
  }
  reference(import.name);
  if (import.kind == ImportKind::Unqualified)
    write(".*");
  if (import.kind == ImportKind::List) {
    write(".{");
    separated(import.names, [&](const Name &name) { write(name.text); });
    write("}");
  }
  comment(import.comment);
}

void Printer::extends(const Extends &extends) {
  write("extends ");
  reference(extends.base);
  modification(extends.modification);
  if (extends.annotation != nullptr) {
    write(" ");
    annotation(extends.annotation);
  }
}

void Printer::componentClause(const ComponentClause &clause) {
  if (clause.flow != Flow::None)
    write(clause.flow == Flow::Flow ? "flow " : "stream ");
  if (clause.variability != Variability::None)
    write(clause.variability == Variability::Discrete    ? "discrete "
          : clause.variability == Variability::Parameter ? "parameter "
                                                         : "constant ");
  if (clause.causality != Causality::None)
    write(clause.causality == Causality::Input ? "input " : "output ");
  if (clause.isCoordinate)
    write("coordinate ");
  reference(clause.type);
  if (clause.hasSubscripts)
    subscripts(clause.subscripts);
  write(" ");
  separated(clause.components, [&](const Component &each) { component(each); });
  constraining(clause);
}

void Printer::component(const Component &component) {
  write(component.name.text.empty() ? "<error>" : component.name.text);
  if (component.hasSubscripts)
    subscripts(component.subscripts);
  modification(component.modification);
  if (component.condition != nullptr) {
    write(" if ");
    expression(*component.condition);
  }
  comment(component.comment);
}

// ---- equations and statements ----------------------------------------------------------------------------------------------------

void Printer::section(const Section &section) {
  line();
  write(sectionText(section.kind));
  bodyLines(section.equations);
  bodyLines(section.statements);
}

template <class Body> void Printer::bodyLines(const List<Body *> &body) {
  ++indent_;
  for (const Body *each : body) {
    line();
    node(*each);
    write(";");
  }
  --indent_;
}

template <class Body> void Printer::branches(std::string_view word, std::string_view other, const List<Branch<Body>> &branches) {
  bool first = true;
  for (const Branch<Body> &branch : branches) {
    if (!first)
      line();
    if (branch.condition != nullptr) {
      write(first ? word : other);
      write(" ");
      expression(*branch.condition);
      write(" then");
    } else {
      write("else");
    }
    first = false;
    bodyLines(branch.body);
  }
  line();
  write("end ");
  write(word);
}

void Printer::equation(const Equation &equation) {
  switch (equation.kind) {
  case EquationKind::Equality:
  case EquationKind::Constraint:
    expression(*equation.left);
    write(relationText(equation.op));
    expression(*equation.right);
    break;
  case EquationKind::If:
    branches("if", "elseif", equation.branches);
    break;
  case EquationKind::When:
    branches("when", "elsewhen", equation.branches);
    break;
  case EquationKind::For:
    write("for ");
    iterators(equation.iterators);
    write(" loop");
    bodyLines(equation.body);
    line();
    write("end for");
    break;
  case EquationKind::Connect:
    write("connect(");
    optional(equation.left);
    write(", ");
    optional(equation.right);
    write(")");
    break;
  case EquationKind::Call:
    expression(*equation.call);
    break;
  case EquationKind::Error:
    write("<error>");
    break;
  }
  comment(equation.comment);
}

void Printer::statement(const Statement &statement) {
  switch (statement.kind) {
  case StatementKind::Assignment:
  case StatementKind::MultiAssignment:
    expression(*statement.left);
    write(" := ");
    expression(*statement.right);
    break;
  case StatementKind::Call:
    expression(*statement.right);
    break;
  case StatementKind::If:
    branches("if", "elseif", statement.branches);
    break;
  case StatementKind::When:
    branches("when", "elsewhen", statement.branches);
    break;
  case StatementKind::For:
    write("for ");
    iterators(statement.iterators);
    write(" loop");
    bodyLines(statement.body);
    line();
    write("end for");
    break;
  case StatementKind::While:
    write("while ");
    expression(*statement.condition);
    write(" loop");
    bodyLines(statement.body);
    line();
    write("end while");
    break;
  case StatementKind::Break:
    write("break");
    break;
  case StatementKind::Return:
    write("return");
    break;
  case StatementKind::Error:
    write("<error>");
    break;
  }
  comment(statement.comment);
}

std::string print(const File &file) {
  Printer printer;
  printer.file(file);
  return printer.take();
}

std::string print(const Expr &expression) {
  Printer printer;
  printer.expression(expression);
  return printer.take();
}

}  // namespace tf::ast
