// The C interface over class Simulation: arguments and phases are checked here, and no exception leaves.
#include "runtime/tf.h"

#include "runtime/model/input_signals.h"
#include "runtime/model/loaded_model.h"
#include "runtime/model/model_instance.h"
#include "runtime/saved_state.h"
#include "runtime/simulate/simulation.h"

#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using tf::runtime::InputFunction;
using tf::runtime::InputSignals;
using tf::runtime::Interpolation;
using tf::runtime::LoadedModel;
using tf::runtime::ModelInstance;
using tf::runtime::Outcome;
using tf::runtime::Simulation;
using tf::runtime::SimulationOptions;

namespace {

constexpr double notAValue = std::numeric_limits<double>::quiet_NaN();

enum class Phase : std::uint8_t {
  Setup,    // before tf_initialise: parameters, starts, options
  Ready,    // there is a current point
  Running,  // inside tf_initialise or tf_step, seen by callbacks
  Failed    // tf_initialise failed: there is no current point
};

// What belongs to one model.
struct Content {
  explicit Content(const tf_model &model) : instance(model), inputs(model.nu) {
    if (std::isfinite(model.tolerance) && model.tolerance > 0)
      options.tolerance = model.tolerance;
  }

  ModelInstance instance;
  InputSignals inputs;
  SimulationOptions options;
  std::unique_ptr<Simulation> simulation;  // of the latest tf_initialise
  tf_event_callback eventCallback = nullptr;
  void *eventData = nullptr;
  tf_note_callback noteCallback = nullptr;
  void *noteData = nullptr;
  bool inEvent = false;       // the event callback is running
  std::exception_ptr thrown;  // by a callback; the call that it belongs to ends with it
  Phase phase = Phase::Setup;
  std::vector<double> values;  // all variables at the current point
  bool valuesAreCurrent = false;
  long long reportedPoints = 0;  // of the simulation, at the last event
};

}  // namespace

struct tf_simulation {
  std::optional<LoadedModel> library;  // outlives the content
  std::unique_ptr<Content> content;    // null after a failed load
  mutable std::string error;
  mutable const char *lastResort = nullptr;  // where there is no memory for a text
};

namespace {

tf_status fail(const tf_simulation *simulation, tf_status status, std::string text) {
  simulation->error = std::move(text);
  return status;
}

tf_status bad(const tf_simulation *simulation, std::string text) { return fail(simulation, TF_BAD_ARGUMENT, std::move(text)); }

tf_status report(const tf_simulation *simulation, const Outcome<void> &outcome) {
  return outcome ? TF_OK : bad(simulation, outcome.error());
}

// Runs `body(content)`; exceptions (no memory, a callback that throws) become TF_FAILED. A call that succeeds leaves the text of the latest
// failure: values of the last good point are read before the text is.
template <class Body> tf_status guarded(const tf_simulation *simulation, const Body &body) noexcept {
  if (simulation == nullptr)
    return TF_BAD_ARGUMENT;
  simulation->lastResort = nullptr;
  try {
    if (simulation->content == nullptr)
      return bad(simulation, "no model was loaded");
    const tf_status status = body(*simulation->content);
    if (simulation->content->thrown)
      std::rethrow_exception(std::exchange(simulation->content->thrown, nullptr));
    return status;
  } catch (const std::bad_alloc &) {
    simulation->lastResort = "out of memory";
  } catch (const std::exception &exception) {
    try {
      simulation->error = exception.what();
    } catch (...) {
      simulation->lastResort = "out of memory";
    }
  } catch (...) {
    simulation->lastResort = "a callback threw an exception";
  }
  return TF_FAILED;
}

// What a callback gives, or `otherwise` where it has thrown: its exception is kept until the simulation is at the end of a step, from which
// it can go on. No more callbacks are called until then.
template <class Call, class Value> Value keepingExceptions(Content &content, const Call &call, Value otherwise) {
  if (content.thrown)
    return otherwise;
  try {
    return call();
  } catch (...) {
    content.thrown = std::current_exception();
    return otherwise;
  }
}

// Settings that a run reads at its start: a run that goes on with others would be neither the old nor the new one, so it ends here.
tf_status beginSetup(const tf_simulation *simulation, Content &content) {
  if (content.phase == Phase::Running)
    return bad(simulation, "the simulation is running: callbacks can only read values");
  content.phase = Phase::Setup;
  return TF_OK;
}

tf_status requirePoint(const tf_simulation *simulation, const Content &content) {
  switch (content.phase) {
  case Phase::Setup:
    return bad(simulation, "call tf_initialise first");
  case Phase::Failed:
    return bad(simulation, "the simulation was not initialised: tf_initialise failed");
  default:
    return TF_OK;
  }
}

// Not from inside a callback.
tf_status requireIdle(const tf_simulation *simulation, const Content &content) {
  return content.phase == Phase::Running ? bad(simulation, "the simulation is running: callbacks can only read values") : TF_OK;
}

#define TF_RETURN_UNLESS_OK(expression)                                                                                                    \
  if (const tf_status status_ = (expression); status_ != TF_OK)                                                                            \
  return status_

// There is a current point, not behind `time`.
tf_status requireEarlier(const tf_simulation *simulation, const Content &content, double time) {
  TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
  TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
  if (!std::isfinite(time) || time < content.simulation->time())
    return bad(simulation, fmt::format("cannot step to time {}: the simulation is at {}", time, content.simulation->time()));
  return TF_OK;
}

// The input called `name`, or an error.
tf_status findInput(const tf_simulation *simulation, const Content &content, const char *name, ModelInstance::Reference &input) {
  if (name == nullptr)
    return bad(simulation, "a name is missing");
  const auto found = content.instance.find(name);
  if (!found)
    return bad(simulation, content.instance.unknownName(name, TF_KIND_INPUT));
  if (content.instance.model().variables[found->variable].kind != TF_KIND_INPUT)
    return bad(simulation, fmt::format("'{}' is not an input", name));
  input = *found;
  return TF_OK;
}

const std::vector<double> &currentValues(Content &content) {
  if (!content.valuesAreCurrent) {
    content.values.resize(static_cast<std::size_t>(content.instance.model().variable_count));
    content.simulation->values(content.values.data());
    content.valuesAreCurrent = content.phase == Phase::Ready || content.inEvent;
  }
  return content.values;
}

// Runs initialise or advanceTo with the phase that callbacks see; the phase after an exception is `onThrow`.
template <class Body> tf_status run(const tf_simulation *simulation, Content &content, Phase onThrow, const Body &body) {
  struct Restore {
    Content &content;
    Phase phase;
    ~Restore() {
      content.phase = phase;
      content.valuesAreCurrent = false;
    }
  } restore{content, onThrow};
  content.phase = Phase::Running;
  content.valuesAreCurrent = false;
  const tf_status status = body(*content.simulation);
  restore.phase = status == TF_OK || status == TF_TERMINATED ? Phase::Ready : onThrow;
  if (status != TF_OK)
    simulation->error = content.simulation->errorText();
  return status;
}

// A run ends where a callback has thrown that gives nothing.
template <class Call> void callOrStop(Content &content, const Call &call) {
  const auto called = [&call] {
    call();
    return true;
  };
  if (!keepingExceptions(content, called, false))
    content.simulation->stop();
}

// Without a callback the simulation does not collect values for one.
void connectEvents(Content &content) {
  if (content.simulation == nullptr)
    return;
  content.simulation->onEvent = nullptr;
  content.simulation->onNote = nullptr;
  if (content.noteCallback != nullptr)
    content.simulation->onNote = [&content](const tf_note &note) {
      content.valuesAreCurrent = false;
      callOrStop(content, [&] { content.noteCallback(content.noteData, &note); });
    };
  if (content.eventCallback == nullptr)
    return;
  content.simulation->onEvent = [&content](const tf_event &event) {
    struct InEvent {
      Content &content;
      ~InEvent() { content.inEvent = false; }
    } inEvent{content};
    content.inEvent = true;
    // Events of many elements at one point.
    if (const long long points = content.simulation->reportedPoints(); points != content.reportedPoints) {
      content.reportedPoints = points;
      content.valuesAreCurrent = false;
    }
    callOrStop(content, [&] { content.eventCallback(content.eventData, &event); });
  };
}

tf_status createContent(tf_simulation *simulation, const tf_model &model) {
  simulation->content = std::make_unique<Content>(model);
  return TF_OK;
}

// `load` fills the new simulation; it exists also if that fails.
template <class Load> tf_status create(tf_simulation **simulation, const Load &load) noexcept {
  if (simulation == nullptr)
    return TF_BAD_ARGUMENT;
  *simulation = new (std::nothrow) tf_simulation;
  if (*simulation == nullptr)
    return TF_FAILED;
  try {
    return load(*simulation);
  } catch (...) {
    (*simulation)->lastResort = "out of memory";
    return TF_FAILED;
  }
}

}  // namespace

extern "C" {

tf_status tf_load(const char *path, tf_simulation **simulation) {
  return create(simulation, [path](tf_simulation *created) {
    if (path == nullptr)
      return bad(created, "the path of the model is missing");
    auto loaded = LoadedModel::open(path);
    if (!loaded)
      return bad(created, loaded.error());
    created->library.emplace(std::move(loaded.value()));
    return createContent(created, created->library->model());
  });
}

tf_status tf_create(const tf_model *model, tf_simulation **simulation) {
  return create(simulation, [model](tf_simulation *created) {
    if (model == nullptr)
      return bad(created, "the model is missing");
    const auto checked = tf::runtime::checkModel(*model);
    return checked ? createContent(created, *model) : bad(created, checked.error());
  });
}

void tf_free(tf_simulation *simulation) {
  if (simulation == nullptr)
    return;
  simulation->content.reset();  // before the library that holds the model's code
  delete simulation;
}

const char *tf_error_text(const tf_simulation *simulation) {
  if (simulation == nullptr)
    return "there is no simulation (a null pointer was given)";
  return simulation->lastResort != nullptr ? simulation->lastResort : simulation->error.c_str();
}

const tf_model *tf_get_model(const tf_simulation *simulation) {
  return simulation == nullptr || simulation->content == nullptr ? nullptr : &simulation->content->instance.model();
}

int32_t tf_find(const tf_simulation *simulation, const char *name) {
  std::int32_t found = -1;
  guarded(simulation, [&](const Content &content) {
    if (name == nullptr)
      return bad(simulation, "a name is missing");
    const auto reference = content.instance.find(name);
    if (!reference)
      return bad(simulation, content.instance.unknownName(name));
    found = reference->variable;
    return TF_OK;
  });
  return found;
}

tf_status tf_set(tf_simulation *simulation, const char *name, double value) {
  return guarded(simulation, [&](Content &content) {
    if (name == nullptr)
      return bad(simulation, "a name is missing");
    const auto reference = content.instance.find(name);
    if (!reference)
      return bad(simulation, content.instance.unknownName(name));
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    const tf_variable &variable = content.instance.model().variables[reference->variable];
    const bool input = variable.kind == TF_KIND_INPUT;
    TF_RETURN_UNLESS_OK(report(simulation, content.instance.set(name, value)));
    if (!input)
      TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    if (input) {
      content.inputs.setConstant(variable.index, reference->sign * value);
      content.valuesAreCurrent = false;
    }
    return TF_OK;
  });
}

tf_status tf_set_input_table(tf_simulation *simulation, const char *name, const double *times, const double *values, size_t count,
                             int linear) {
  return guarded(simulation, [&](Content &content) {
    ModelInstance::Reference input;
    TF_RETURN_UNLESS_OK(findInput(simulation, content, name, input));
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    if (count == 0 || times == nullptr || values == nullptr)
      return bad(simulation, fmt::format("the table of '{}' has no points", name));
    std::vector<double> own(values, values + count);
    for (double &value : own)
      value *= input.sign;
    const tf_variable &variable = content.instance.model().variables[input.variable];
    if (linear != 0 && (variable.flags & (TF_BOOLEAN | TF_INTEGER)) != 0)
      return bad(simulation, fmt::format("'{}' is Boolean or Integer and cannot be interpolated linearly", name));
    for (const double value : own)
      TF_RETURN_UNLESS_OK(report(simulation, content.instance.checkValue(input.variable, value, variable.name)));
    const auto set =
        content.inputs.setTable(variable.index, {times, count}, own, linear != 0 ? Interpolation::Linear : Interpolation::ZeroOrderHold);
    content.valuesAreCurrent = false;
    return set ? TF_OK : bad(simulation, fmt::format("the table of '{}': {}", name, set.error()));
  });
}

tf_status tf_set_input_callback(tf_simulation *simulation, const char *name, tf_input_value value, tf_input_breakpoint next_breakpoint,
                                void *data) {
  return guarded(simulation, [&](Content &content) {
    ModelInstance::Reference input;
    TF_RETURN_UNLESS_OK(findInput(simulation, content, name, input));
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    if (value == nullptr)
      return bad(simulation, fmt::format("the callback for '{}' is missing", name));
    InputFunction function;
    function.value = [&content, value, data, sign = input.sign](double time, double segment) {
      return keepingExceptions(content, [&] { return sign * value(data, time, segment); }, notAValue);
    };
    if (next_breakpoint != nullptr)
      function.nextBreakpoint = [&content, next_breakpoint, data, own = std::string(name)](double time) {
        const auto breakpoint = [&] {
          const double next = next_breakpoint(data, time);
          if (!(next > time))
            throw std::invalid_argument(fmt::format("the breakpoint of '{}' after time {} cannot be at {}", own, time, next));
          return next;
        };
        return keepingExceptions(content, breakpoint, std::numeric_limits<double>::infinity());
      };
    content.inputs.setFunction(content.instance.model().variables[input.variable].index, std::move(function));
    content.valuesAreCurrent = false;
    return TF_OK;
  });
}

tf_status tf_set_tolerance(tf_simulation *simulation, double tolerance) {
  return guarded(simulation, [&](Content &content) {
    if (!(tolerance > 0 && tolerance < 1))
      return bad(simulation, fmt::format("the tolerance must be between 0 and 1, not {}", tolerance));
    TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    content.options.tolerance = tolerance;
    return TF_OK;
  });
}

tf_status tf_set_integrator(tf_simulation *simulation, tf_integrator integrator) {
  return guarded(simulation, [&](Content &content) {
    if (integrator < TF_AUTO || integrator > TF_EXPLICIT)
      return bad(simulation, fmt::format("there is no integrator number {}", static_cast<int>(integrator)));
    TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    content.options.integrator = integrator;
    return TF_OK;
  });
}

tf_status tf_set_step_options(tf_simulation *simulation, int stages, double fixed_step) {
  return guarded(simulation, [&](Content &content) {
    if (stages < 0 || stages > 4)
      return bad(simulation, fmt::format("the number of stages must be 1 to 4, or 0 for an automatic choice, not {}", stages));
    if (!(fixed_step >= 0 && std::isfinite(fixed_step)))
      return bad(simulation, fmt::format("a fixed step must be positive, or 0 for error control, not {}", fixed_step));
    TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    content.options.stages = stages;
    content.options.fixedStep = fixed_step;
    return TF_OK;
  });
}

tf_status tf_set_longest_step(tf_simulation *simulation, double length) {
  return guarded(simulation, [&](Content &content) {
    if (!(length > 0))
      return bad(simulation, fmt::format("the longest step must be positive, not {}", length));
    TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    content.options.longestStep = length;
    return TF_OK;
  });
}

tf_status tf_set_energy_balance(tf_simulation *simulation, int on) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    content.options.energyBalance = on != 0;
    return TF_OK;
  });
}

tf_status tf_set_sensitivities(tf_simulation *simulation, const char *const *names, size_t count) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(beginSetup(simulation, content));
    std::vector<std::int32_t> columns;
    for (size_t k = 0; k < count; ++k) {
      if (names == nullptr || names[k] == nullptr)
        return bad(simulation, "a name is missing");
      const auto found = content.instance.find(names[k]);
      if (!found)
        return bad(simulation, content.instance.unknownName(names[k]));
      const tf_variable &variable = content.instance.model().variables[found->variable];
      const bool isSource = variable.kind == TF_KIND_PARAMETER || variable.kind == TF_KIND_COORDINATE ||
                            variable.kind == TF_KIND_VELOCITY || variable.kind == TF_KIND_STATE || variable.kind == TF_KIND_INPUT;
      const int discrete = TF_STRUCTURAL | TF_BOOLEAN | TF_INTEGER;
      if (!isSource || (variable.flags & discrete) != 0 || found->sign < 0)
        return bad(simulation, fmt::format("'{}' is no real parameter, start or input to differentiate by", names[k]));
      columns.push_back(found->variable);
    }
    content.options.sensitivities = std::move(columns);
    return TF_OK;
  });
}

tf_status tf_get_sensitivity(tf_simulation *simulation, size_t column, double *values) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    if (column >= content.options.sensitivities.size())
      return bad(simulation, fmt::format("there are {} sensitivities, not {}", content.options.sensitivities.size(), column + 1));
    if (values == nullptr)
      return bad(simulation, "the array for the values is missing");
    if (!content.simulation->sensitivity(static_cast<int>(column), values))
      return bad(simulation, "the sensitivities cannot be evaluated here");
    return TF_OK;
  });
}

tf_status tf_get_sensitivity_before(tf_simulation *simulation, size_t column, double *values) {
  return guarded(simulation, [&](Content &content) {
    if (!content.inEvent)
      return bad(simulation, "values before an event exist in the event callback only");
    if (column >= content.options.sensitivities.size())
      return bad(simulation, fmt::format("there are {} sensitivities, not {}", content.options.sensitivities.size(), column + 1));
    if (values == nullptr)
      return bad(simulation, "the array for the values is missing");
    content.simulation->sensitivityBeforeEvent(static_cast<int>(column), values);
    return TF_OK;
  });
}

tf_status tf_set_event_callback(tf_simulation *simulation, tf_event_callback callback, void *data) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    content.eventCallback = callback;
    content.eventData = data;
    connectEvents(content);
    return TF_OK;
  });
}

tf_status tf_set_note_callback(tf_simulation *simulation, tf_note_callback callback, void *data) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    content.noteCallback = callback;
    content.noteData = data;
    connectEvents(content);
    return TF_OK;
  });
}

tf_status tf_initialise(tf_simulation *simulation, double start_time) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    if (!std::isfinite(start_time))
      return bad(simulation, fmt::format("the start time must be finite, not {}", start_time));
    TF_RETURN_UNLESS_OK(report(simulation, content.instance.checkParameters()));
    if (content.simulation == nullptr)
      content.simulation = std::make_unique<Simulation>(content.instance, content.inputs);
    content.simulation->options = content.options;
    connectEvents(content);
    return run(simulation, content, Phase::Failed, [&](Simulation &started) { return started.initialise(start_time); });
  });
}

tf_status tf_step(tf_simulation *simulation, double time) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requireEarlier(simulation, content, time));
    return run(simulation, content, Phase::Ready, [&](Simulation &running) { return running.advanceTo(time); });
  });
}

tf_status tf_run(tf_simulation *simulation, double end, double first_sample, tf_sample_callback callback, void *data) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requireEarlier(simulation, content, end));
    if (callback == nullptr)
      return bad(simulation, "a callback for the samples is missing");
    if (!(first_sample >= content.simulation->time()))
      return bad(simulation,
                 fmt::format("cannot take a sample at time {}: the simulation is at {}", first_sample, content.simulation->time()));
    std::string refused;
    content.simulation->onSample = [&](double time) {
      content.valuesAreCurrent = false;
      const double next = keepingExceptions(content, [&] { return callback(data, time); }, notAValue);
      if (!(next <= time))
        return next;
      refused = fmt::format("cannot take a sample at time {} after that at {}", next, time);
      return notAValue;
    };
    const tf_status status =
        run(simulation, content, Phase::Ready, [&](Simulation &running) { return running.advanceTo(end, first_sample); });
    return refused.empty() ? status : bad(simulation, std::move(refused));
  });
}

double tf_time(const tf_simulation *simulation) {
  double time = notAValue;
  guarded(simulation, [&](const Content &content) {
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    time = content.simulation->time();
    return TF_OK;
  });
  return time;
}

double tf_get(tf_simulation *simulation, int32_t index) {
  double value = notAValue;
  guarded(simulation, [&](Content &content) {
    const tf_model &model = content.instance.model();
    if (index < 0 || index >= model.variable_count)
      return bad(simulation, fmt::format("there is no variable number {}: the model has {}", index, model.variable_count));
    const tf_variable &variable = model.variables[index];
    if (variable.kind == TF_KIND_PARAMETER) {  // known before the start
      value = content.instance.parameters()[static_cast<std::size_t>(variable.index)];
      return TF_OK;
    }
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    value = currentValues(content)[static_cast<std::size_t>(index)];
    return TF_OK;
  });
  return value;
}

tf_status tf_get_all(tf_simulation *simulation, double *values) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    if (values == nullptr)
      return bad(simulation, "the array for the values is missing");
    const std::vector<double> &current = currentValues(content);
    std::copy(current.begin(), current.end(), values);
    return TF_OK;
  });
}

tf_status tf_get_all_before(tf_simulation *simulation, double *values) {
  return guarded(simulation, [&](Content &content) {
    if (!content.inEvent)
      return bad(simulation, "values before an event are known in the event callback only");
    if (values == nullptr)
      return bad(simulation, "the array for the values is missing");
    content.simulation->valuesBeforeEvent(values);
    return TF_OK;
  });
}

tf_status tf_get_named(tf_simulation *simulation, const char *name, double *value) {
  if (value != nullptr)
    *value = notAValue;
  return guarded(simulation, [&](Content &content) {
    if (name == nullptr || value == nullptr)
      return bad(simulation, name == nullptr ? "a name is missing" : "the place for the value is missing");
    const auto reference = content.instance.find(name);
    if (!reference)
      return bad(simulation, content.instance.unknownName(name));
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    *value = reference->sign * currentValues(content)[static_cast<std::size_t>(reference->variable)];
    return TF_OK;
  });
}

size_t tf_state_size(const tf_simulation *simulation) {
  std::size_t size = 0;
  guarded(simulation, [&](const Content &content) {
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    size = tf::runtime::savedStateSize(content.inputs, *content.simulation);
    return TF_OK;
  });
  return size;
}

tf_status tf_save_state(const tf_simulation *simulation, void *buffer, size_t size) {
  return guarded(simulation, [&](const Content &content) {
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    const std::size_t needed = tf::runtime::savedStateSize(content.inputs, *content.simulation);
    if (buffer == nullptr || size < needed)
      return bad(simulation, fmt::format("the state needs {} bytes", needed));
    tf::runtime::saveState(content.instance, content.inputs, *content.simulation, buffer);
    return TF_OK;
  });
}

tf_status tf_restore_state(tf_simulation *simulation, const void *buffer, size_t size) {
  return guarded(simulation, [&](Content &content) {
    TF_RETURN_UNLESS_OK(requirePoint(simulation, content));
    TF_RETURN_UNLESS_OK(requireIdle(simulation, content));
    content.valuesAreCurrent = false;
    return report(simulation, tf::runtime::restoreState(content.instance, content.inputs, *content.simulation, buffer, size));
  });
}

const tf_statistics *tf_get_statistics(const tf_simulation *simulation) {
  static const tf_statistics none{};
  if (simulation == nullptr || simulation->content == nullptr || simulation->content->simulation == nullptr)
    return &none;
  return &simulation->content->simulation->statistics();
}

}  // extern "C"
