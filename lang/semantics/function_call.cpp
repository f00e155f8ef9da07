// Calls of functions: arguments, defaults, vectorisation (MLS 12.4), external functions of the math library.
#include "lang/semantics/builtin_functions.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/function_body.h"
#include "lang/semantics/lookup.h"

#include <algorithm>

namespace tf::semantics {

namespace {

struct Parameter {
  const Component *component = nullptr;
  ExprPtr argument;
};

class FunctionCall {
public:
  FunctionCall(Typer &typer, Class &function, const ast::Expr &call)
      : typer_(typer), context_(typer.context()), function_(function), call_(call) {}

  std::optional<std::vector<ExprPtr>> run() {
    elaborate(context_, function_);
    if (function_.isFailed)
      return std::nullopt;
    if (function_.definition->isPartial) {
      context_.diagnostics.report(diag::PartialModel, call_.reference.span, function_.name);
      return std::nullopt;
    }
    for (const Member &member : function_.members)
      if (member.component != nullptr && member.component->clause->causality == ast::Causality::Input)
        inputs_.push_back({member.component, nullptr});
    if (!call_.iterators.empty()) {
      context_.diagnostics.report(diag::NotAReduction, call_.reference.span, function_.name);
      return std::nullopt;
    }
    if (!arrange())
      return std::nullopt;
    const std::optional<std::vector<int>> dims = vectorDims();
    return dims ? mapOver(*dims, {}) : std::nullopt;
  }

private:
  bool arrange() {
    if (call_.operands.size() > inputs_.size()) {
      context_.diagnostics.report(diag::ArgumentCount, call_.span, function_.name,
                                  fmt::format("{} argument{}", inputs_.size(), inputs_.size() == 1 ? "" : "s"), call_.operands.size());
      return false;
    }
    bool isRight = true;
    for (std::size_t i = 0; i < call_.operands.size(); ++i)
      isRight = setArgument(inputs_[i], *call_.operands[i], call_.operands[i]->span) && isRight;
    for (const ast::NamedArgument &named : call_.named) {
      const auto input = std::ranges::find_if(inputs_, [&](const Parameter &entry) { return entry.component->name == named.name.text; });
      if (input == inputs_.end()) {
        std::vector<std::string> names;
        names.reserve(inputs_.size());
        for (const Parameter &entry : inputs_)
          names.emplace_back(entry.component->name);
        context_.diagnostics.report(diag::UnknownArgument, named.name.span, function_.name, named.name.text)
            .suggest(named.name.text, names);
        return false;
      }
      isRight = named.value != nullptr && setArgument(*input, *named.value, named.name.span) && isRight;
    }
    for (const Parameter &input : inputs_)
      if (isRight && input.argument == nullptr && (!input.component->modifier || !input.component->modifier->binding)) {
        context_.diagnostics.report(diag::ArgumentMissing, call_.span, input.component->name, function_.name);
        return false;
      }
    return isRight;
  }

  bool setArgument(Parameter &input, const ast::Expr &value, Span span) {
    if (input.argument != nullptr) {
      context_.diagnostics.report(diag::ArgumentTwice, span, input.component->name);
      return false;
    }
    input.argument = typer_.type(value);
    return input.argument != nullptr;
  }

  [[nodiscard]] static std::size_t declaredRank(const Component &component) {
    return component.declaration->subscripts.size() + component.clause->subscripts.size();
  }

  // Leading dimensions of arguments that the inputs do not have: the function is applied to each element (MLS 12.4.6).
  std::optional<std::vector<int>> vectorDims() {
    std::vector<int> dims;
    for (const Parameter &input : inputs_) {
      if (input.argument == nullptr)
        continue;
      const std::vector<int> &given = input.argument->type.dims;
      const std::size_t rank = inputRank(*input.component);
      if (given.size() <= rank)
        continue;
      const std::vector<int> leading(given.begin(), given.end() - static_cast<std::ptrdiff_t>(rank));
      if (!dims.empty() && dims != leading) {
        context_.diagnostics.report(diag::ShapeMismatch, input.argument->span, input.component->name, toString({Base::Real, dims}),
                                    toString(input.argument->type));
        return std::nullopt;
      }
      dims = leading;
    }
    return dims;
  }

  std::size_t inputRank(const Component &component) {
    std::size_t rank = declaredRank(component);
    if (Class *type = lookupClass(context_, *component.scope, component.clause->type)) {
      elaborate(context_, *type);
      rank += type->dimensions.size();
    }
    return rank;
  }

  std::optional<std::vector<ExprPtr>> mapOver(const std::vector<int> &dims, const std::vector<int> &index) {
    if (dims.empty())
      return callOnce(index);
    std::vector<std::vector<ExprPtr>> columns;
    for (int i = 1; i <= dims[0]; ++i) {
      std::vector<int> at = index;
      at.push_back(i);
      const auto outputs = mapOver({dims.begin() + 1, dims.end()}, at);
      if (!outputs)
        return std::nullopt;
      columns.resize(outputs->size());
      for (std::size_t k = 0; k < outputs->size(); ++k)
        columns[k].push_back((*outputs)[k]);
    }
    std::vector<ExprPtr> result;
    for (std::vector<ExprPtr> &column : columns) {
      result.push_back(makeArray(std::move(column), call_.span, context_.diagnostics));
      if (result.back() == nullptr)
        return std::nullopt;
    }
    return result;
  }

  std::optional<std::vector<ExprPtr>> callOnce(const std::vector<int> &index) {
    const bool isUnreached = typer_.scope().isUnreached;
    FunctionBody body(context_, function_, isUnreached);
    // A recursion ends behind a condition that is decided.
    if (isUnreached && std::ranges::find(context_.expandedFunctions, &function_) != context_.expandedFunctions.end())
      return blankOutputs(body, index);
    context_.expandedFunctions.push_back(&function_);
    auto outputs = expand(body, index);
    context_.expandedFunctions.pop_back();
    return outputs;
  }

  std::optional<std::vector<ExprPtr>> expand(FunctionBody &body, const std::vector<int> &index) {
    for (const Member &member : function_.members)
      if (member.component != nullptr && !declareVariable(body, *member.component, index))
        return std::nullopt;
    if (const ast::External *external = externalOf(function_))
      return callExternal(body, *external);
    return body.run() ? outputsOf(body) : std::nullopt;
  }

  // Values of the outputs' types, for a call whose values are not needed.
  std::optional<std::vector<ExprPtr>> blankOutputs(FunctionBody &body, const std::vector<int> &index) {
    std::vector<ExprPtr> outputs;
    for (const Member &member : function_.members) {
      if (member.component == nullptr || member.component->clause->causality == ast::Causality::None)
        continue;
      if (!declareVariable(body, *member.component, index))
        return std::nullopt;
      if (member.component->clause->causality == ast::Causality::Output)
        outputs.push_back(makeBlank(body.typeOf(member.name), {}, call_.span));
    }
    return outputs.empty() ? std::nullopt : std::optional(std::move(outputs));
  }

  std::optional<std::vector<ExprPtr>> outputsOf(const FunctionBody &body) {
    std::vector<ExprPtr> outputs;
    for (const Member &member : function_.members) {
      if (member.component == nullptr || member.component->clause->causality != ast::Causality::Output)
        continue;
      outputs.push_back(body.value(member.name));
      if (outputs.back() != nullptr)
        continue;
      context_.diagnostics.report(diag::FunctionBody, member.span, fmt::format("the output '{}' gets no value", member.name));
      return std::nullopt;
    }
    if (!outputs.empty())
      return outputs;
    context_.diagnostics.report(diag::FunctionBody, function_.definition->name.span, "there is no output");
    return std::nullopt;
  }

  bool declareVariable(FunctionBody &body, const Component &component, const std::vector<int> &index) {
    Class *type = lookupClass(context_, *component.scope, component.clause->type);
    if (type == nullptr)
      return false;
    elaborate(context_, *type);
    if (type->predefined == nullptr || type->predefined->isElement() || type->predefined->kind == PredefinedKind::Rotation) {
      context_.diagnostics.report(diag::NotSupported, component.clause->type.span, "a record in a function");
      return false;
    }
    ExprPtr value;
    const auto input = std::ranges::find(inputs_, &component, &Parameter::component);
    if (input != inputs_.end() && input->argument != nullptr) {
      value = input->argument;
      if (value->type.dims.size() > inputRank(component))
        value = elementAt(value, index, value->span);
    } else if (component.modifier && component.modifier->binding) {
      value = body.typer().type(*component.modifier->binding->expression);
      if (value == nullptr)
        return false;
    }
    Type declared{baseOf(type->predefined->kind), {}};
    if (!evaluateDimensions(body, component, *type, value, declared.dims))
      return false;
    if (value != nullptr && declared.base == Base::Real)
      value = toReal(value);
    if (value != nullptr && value->type != declared) {
      context_.diagnostics.report(diag::BindingType, value->span, component.name, toString(declared), toString(value->type));
      return false;
    }
    body.declare(component.name, std::move(declared), std::move(value));
    return true;
  }

  bool evaluateDimensions(FunctionBody &body, const Component &component, const Class &type, const ExprPtr &value, std::vector<int> &dims) {
    std::vector<const ast::Expr *> sizes(component.declaration->subscripts.begin(), component.declaration->subscripts.end());
    sizes.insert(sizes.end(), component.clause->subscripts.begin(), component.clause->subscripts.end());
    for (const Dimension &dimension : type.dimensions)
      sizes.push_back(dimension.size);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (sizes[i]->kind == ast::ExprKind::Colon) {
        if (value == nullptr || i >= value->type.dims.size()) {
          context_.diagnostics.report(diag::SizeUnknown, sizes[i]->span, component.name);
          return false;
        }
        dims.push_back(value->type.dims[i]);
        continue;
      }
      Typer typer = body.typer();
      const ExprPtr size = typer.type(*sizes[i]);
      const auto known = size == nullptr ? std::nullopt : constantSize(typer, size, "the size of an array");
      if (!known)
        return false;
      dims.push_back(*known);
    }
    return true;
  }

  static const ast::External *externalOf(const Class &function) {
    if (function.definition != nullptr && function.definition->external != nullptr)
      return function.definition->external;
    for (const Class *base : function.bases)
      if (const ast::External *external = externalOf(*base))
        return external;
    return nullptr;
  }

  // `external "builtin" y = sin(u)` stands for the builtin function.
  std::optional<std::vector<ExprPtr>> callExternal(FunctionBody &body, const ast::External &external) {
    const std::string_view name = external.function.text.empty() ? function_.name : external.function.text;
    const auto functions = mathFunctions();
    if (std::ranges::find(functions, name, &BuiltinFunction::name) == functions.end()) {
      context_.diagnostics.report(diag::NotSupported, call_.reference.span, "an external function beyond the math library");
      return std::nullopt;
    }
    ast::Expr call = call_;
    std::vector<ast::Expr *> arguments(external.arguments.begin(), external.arguments.end());
    std::deque<ast::Expr> inputs;
    if (external.function.text.empty())
      for (const Parameter &input : inputs_)
        arguments.push_back(&inputReference(inputs, *input.component));
    call.operands = {arguments.data(), static_cast<std::uint32_t>(arguments.size())};
    call.named = {};
    Typer typer = body.typer();
    const ExprPtr value = typeBuiltinCall(typer, name, call);
    return value == nullptr ? std::nullopt : std::optional(std::vector<ExprPtr>{value});
  }

  ast::Expr &inputReference(std::deque<ast::Expr> &storage, const Component &input) {
    ast::ReferencePart &part = parts_.emplace_back();
    part.name = {input.name, call_.span};
    ast::Expr &expr = storage.emplace_back();
    expr.kind = ast::ExprKind::Reference;
    expr.span = call_.span;
    expr.reference.parts = {&part, 1};
    expr.reference.span = call_.span;
    return expr;
  }

  Typer &typer_;
  Context &context_;
  Class &function_;
  const ast::Expr &call_;
  std::vector<Parameter> inputs_;
  std::deque<ast::ReferencePart> parts_;
};

}  // namespace

std::optional<std::vector<ExprPtr>> typeFunctionOutputs(Typer &typer, Class &function, const ast::Expr &call) {
  return FunctionCall(typer, function, call).run();
}

ExprPtr typeFunctionCall(Typer &typer, Class &function, const ast::Expr &call) {
  const auto outputs = typeFunctionOutputs(typer, function, call);
  return outputs ? outputs->front() : nullptr;
}

}  // namespace tf::semantics
