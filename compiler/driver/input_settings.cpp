#include "compiler/driver/input_settings.h"
#include "compiler/driver/diagnostics.h"
#include "runtime/results/csv_reader.h"

#include <cmath>
#include <set>

namespace tf::driver {

namespace {

using runtime::ModelInstance;

class Application {
public:
  Application(PreparedModel &prepared, const RunOptions &options, TimeSpan span, Session &session)
      : prepared_(prepared), options_(options), span_(span), session_(session), instance_(prepared.model()) {}

  // Numbers first, then expressions of numbers and parameters in order.
  void constants(const std::vector<Setting> &settings) {
    for (const Setting &setting : settings) {
      const auto reference = instance_.find(setting.name);
      const tf_variable *variable = reference ? &prepared_.model().variables[reference->variable] : nullptr;
      const bool isInput = variable != nullptr && variable->kind == TF_KIND_INPUT;
      if (isInput)
        set_.insert(variable->index);
      if (variable != nullptr && (variable->flags & TF_STRUCTURAL) != 0)
        structural(setting);
      else if (setting.number)
        constant(setting);
      else if (variable == nullptr)
        refuse(setting, instance_.unknownName(setting.name));
      else
        (isInput ? inputExpressions_ : constantExpressions_).push_back(&setting);
    }
    for (const Setting *setting : constantExpressions_) {
      if (const auto value = constantExpression(*setting))
        constant({setting->name, setting->value, value});
    }
  }

  void table() {
    if (options_.inputTable.empty() || !checkReadable({options_.inputTable}, session_))
      return;
    const auto tables = runtime::readInputTables(options_.inputTable, instance_);
    if (!tables) {
      session_.diagnostics.report(diag::BadInputTable, {}, tables.error());
      return;
    }
    for (const runtime::InputTable &table : tables.value()) {
      const std::string name = instance_.nameOf(TF_KIND_INPUT, table.input);
      if (set_.contains(table.input))
        session_.diagnostics.report(diag::InputTwice, {}, name, options_.inputTable);
      else if (tf_set_input_table(simulation(), name.c_str(), table.times.data(), table.values.data(), table.times.size(),
                                  options_.linearInput ? 1 : 0) != TF_OK)
        session_.diagnostics.report(diag::BadInputTable, {}, tf_error_text(simulation()));
    }
  }

  InputExpressions expressions() {
    InputExpressions result;
    for (const Setting *setting : inputExpressions_) {
      auto expression = InputExpression::parse(setting->name, setting->value, instance_, span_.start, span_.stop, session_);
      if (!expression)
        continue;
      checkDependence(*setting, *expression);
      result.push_back(std::make_unique<InputExpression>(std::move(*expression)));
      const auto value = [](void *data, double time, double segment) { return static_cast<InputExpression *>(data)->value(time, segment); };
      const auto breakpoint = [](void *data, double time) { return static_cast<InputExpression *>(data)->nextBreakpoint(time); };
      if (tf_set_input_callback(simulation(), setting->name.c_str(), value, breakpoint, result.back().get()) != TF_OK)
        refuse(*setting, tf_error_text(simulation()));
    }
    return result;
  }

private:
  tf_simulation *simulation() { return prepared_.simulation.get(); }

  void refuse(const Setting &setting, const std::string &reason) {
    session_.diagnostics.report(diag::RefusedSetting, {}, setting.name + "=" + setting.value, reason);
  }

  // A source was compiled with the value; nothing is left to do.
  void structural(const Setting &setting) {
    if (!prepared_.isSource)
      session_.diagnostics.report(diag::CompiledIn, {}, setting.name, options_.files.front());
    else if (!setting.number)
      session_.diagnostics.report(diag::NeedsConstant, {}, setting.name);
  }

  // `--set phi=3.1416/6`: an expression of numbers and parameters.
  std::optional<double> constantExpression(const Setting &setting) {
    auto expression = InputExpression::parse(setting.name, setting.value, instance_, span_.start, span_.stop, session_);
    if (expression && !expression->isConstant()) {
      session_.diagnostics.report(diag::NeedsConstant, {}, setting.name);
      return std::nullopt;
    }
    if (!expression)
      return std::nullopt;
    checkDependence(setting, *expression);
    return expression->value(span_.start, span_.start);
  }

  // The model takes the values of expressions, not the expressions: derivatives by what they depend on would be wrong.
  void checkDependence(const Setting &setting, const InputExpression &expression) {
    constexpr double change = 1e-3;
    for (const std::string &name : options_.sensitivities) {
      const auto reference = instance_.find(name);
      if (!reference || prepared_.model().variables[reference->variable].kind != TF_KIND_PARAMETER)
        continue;
      const tf_variable &parameter = prepared_.model().variables[reference->variable];
      const double value = instance_.parameters()[static_cast<std::size_t>(parameter.index)];
      ModelInstance other = instance_;
      other.nudge(reference->variable, change * (value != 0 ? value : 1), span_.start);
      for (const InputExpression::Use &use : expression.uses()) {
        const auto index = static_cast<std::size_t>(use.parameter);
        if (instance_.parameters()[index] == other.parameters()[index])
          continue;
        session_.diagnostics.report(diag::HiddenDependence, use.span, setting.name, parameter.name, name);
        break;
      }
    }
  }

  void constant(const Setting &setting) {
    auto own = instance_.set(setting.name, *setting.number);
    if (!own)
      refuse(setting, own.error());
    else if (tf_set(simulation(), setting.name.c_str(), *setting.number) != TF_OK)
      refuse(setting, tf_error_text(simulation()));
  }

  PreparedModel &prepared_;
  const RunOptions &options_;
  TimeSpan span_;
  Session &session_;
  ModelInstance instance_;  // the names, and the parameters as set so far
  std::set<std::int32_t> set_;
  std::vector<const Setting *> constantExpressions_, inputExpressions_;
};

}  // namespace

InputExpressions applySettings(PreparedModel &prepared, const RunOptions &options, const std::vector<Setting> &settings, TimeSpan span,
                               Session &session) {
  Application application(prepared, options, span, session);
  application.constants(settings);
  application.table();
  return session.diagnostics.hasErrors() ? InputExpressions() : application.expressions();
}

}  // namespace tf::driver
