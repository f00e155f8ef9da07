#include "compiler/driver/options.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/same_file.h"
#include "compiler/driver/version.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace tf::driver {

namespace {

constexpr const char *kDescription =
    "tfc compiles and runs models of mechanical systems with contact, friction and switches, written in the TF language.";
constexpr const char *kFooter =
    "Exit codes: 0 done; 1 the model is wrong; 2 the command line is wrong; 3 the run failed, with everything computed so far "
    "written.\nThe reference is lang/reference/command-line.md.";

template <class Value> struct Choice {
  const char *name;
  Value value;
};

constexpr std::array<Choice<Emit>, 11> kEmit = {{{"ast", Emit::Ast},
                                                 {"flat", Emit::Flat},
                                                 {"cls", Emit::Cls},
                                                 {"pss", Emit::Pss},
                                                 {"stewart", Emit::Stewart},
                                                 {"step", Emit::Step},
                                                 {"llvm-ir", Emit::LlvmIr},
                                                 {"asm", Emit::Assembly},
                                                 {"obj", Emit::Object},
                                                 {"shared", Emit::Shared},
                                                 {"header", Emit::Header}}};
constexpr std::array<Choice<tf_integrator>, 4> kIntegrators = {
    {{"auto", TF_AUTO}, {"step", TF_STEP}, {"cvode", TF_CVODE}, {"explicit", TF_EXPLICIT}}};
constexpr std::array<Choice<EventRows>, 2> kEventRows = {{{"both", EventRows::Both}, {"after", EventRows::After}}};
constexpr std::array<Choice<bool>, 2> kInterpolations = {{{"hold", false}, {"linear", true}}};

// Values are collected as text, so that every mistake is found here and told in the program's own form.
using Values = std::vector<std::string>;

class Reader {
public:
  explicit Reader(Diagnostics &diagnostics) : diagnostics_(diagnostics) {}

  // The value of an option that may be given once; nothing if it was not given.
  std::optional<std::string> single(const char *option, const Values &values) {
    if (values.size() > 1)
      diagnostics_.report(diag::RepeatedOption, {}, option);
    return values.empty() ? std::nullopt : std::optional(values.front());
  }

  std::optional<double> number(const char *option, const Values &values) {
    const auto text = single(option, values);
    if (!text)
      return std::nullopt;
    double value = 0;
    const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
    if (error != std::errc() || end != text->data() + text->size() || !std::isfinite(value)) {
      diagnostics_.report(diag::NotANumber, {}, option, *text);
      return std::nullopt;
    }
    return value;
  }

  std::optional<double> positive(const char *option, const Values &values) {
    const auto value = number(option, values);
    if (value && *value <= 0)
      diagnostics_.report(diag::OutOfRange, {}, option, "a positive number", values.front());
    return value;
  }

  std::optional<double> fraction(const char *option, const Values &values) {
    const auto value = number(option, values);
    if (value && !(*value > 0 && *value < 1))
      diagnostics_.report(diag::OutOfRange, {}, option, "a number between 0 and 1", values.front());
    return value;
  }

  // The name of a file or a model; empty if it was not given.
  std::string name(const char *option, const Values &values) {
    const auto text = single(option, values);
    if (text && text->empty())
      diagnostics_.report(diag::MissingValue, {}, option);
    return text.value_or("");
  }

  std::optional<int> integer(const char *option, const Values &values, int least, int most) {
    const auto value = number(option, values);
    if (value && (*value < least || *value > most || *value != std::floor(*value)))
      diagnostics_.report(diag::OutOfRange, {}, option, fmt::format("a whole number from {} to {}", least, most), values.front());
    return value ? std::optional(static_cast<int>(std::clamp(*value, double(least), double(most)))) : std::nullopt;
  }

  template <class Value, std::size_t N>
  Value choice(const char *option, const Values &values, const std::array<Choice<Value>, N> &choices, Value otherwise) {
    const auto text = single(option, values);
    if (!text)
      return otherwise;
    Values names;
    for (const auto &choice : choices) {
      if (*text == choice.name)
        return choice.value;
      names.emplace_back(choice.name);
    }
    diagnostics_.report(diag::BadChoice, {}, option, fmt::format("{}", fmt::join(names, ", ")), *text).suggest(*text, names);
    return otherwise;
  }

private:
  Diagnostics &diagnostics_;
};

// The options of one command in CLI11's terms; `finish` reads what it collected.
class Syntax {
public:
  Syntax(CLI::App &parent, const char *name, const char *description) : app(parent.add_subcommand(name, description)) {
    app->allow_extras();
    app->footer(kFooter);
    app->add_option("FILE", files, "source files (.tf or .mo)")->type_name("");
    option("--model", model, "NAME", "the model to take, if the files contain several");
    option("-L", libraries, "DIR", "folder to look for classes in (repeatable)");
    option("--set", settings, "NAME=VALUE",
           "set a parameter, a start (also der(x)=1) or an input (a number, or an expression of time and parameters; repeatable)");
  }

  CLI::Option *option(const std::string &names, Values &values, const char *placeholder, const char *description) {
    return app->add_option(names, values, description)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->type_name(placeholder);
  }

  void finish(ModelOptions &options, Reader &reader, Diagnostics &diagnostics) const {
    options.files = files;
    options.model = reader.name("--model", model);
    options.libraries = libraries;
    options.settings = settings;
    if (files.empty())
      diagnostics.report(diag::MissingFile, {}, app->get_name());
  }

  CLI::App *app;
  Values files, model, libraries, settings;
};

struct CompileSyntax : Syntax {
  explicit CompileSyntax(CLI::App &parent) : Syntax(parent, "compile", "compile a model to a shared library, or show any form on the way") {
    option("-o,--output", output, "FILE",
           "where to write; '-' is the standard output [<Model>.so, <Model>.o; text to the standard output]");
    option("--emit", emit, "FORM", "ast, flat, cls, pss, stewart, step, llvm-ir, asm, obj, shared or header [shared]");
    option("-O", optimization, "LEVEL", "optimization, 0 to 3 [2]");
  }

  Values output, emit, optimization;

  void finish(CompileOptions &options, Reader &reader, Diagnostics &diagnostics) const {
    Syntax::finish(options, reader, diagnostics);
    options.output = reader.name("-o", output);
    options.emit = reader.choice("--emit", emit, kEmit, Emit::Shared);
    options.optimization = reader.integer("-O", optimization, 0, 3).value_or(2);
  }
};

struct RunSyntax : Syntax {
  explicit RunSyntax(CLI::App &parent) : Syntax(parent, "run", "simulate a model: a source or a compiled model") {
    option("--input", input, "FILE.csv", "table of inputs: a header row with time and names of inputs, then rows of numbers");
    option("--input-interpolation", interpolation, "hold|linear", "between the rows of the table [hold]");
    option("--start-time", startTime, "T", "[annotation experiment, else 0]");
    option("--stop-time", stopTime, "T", "[annotation experiment, else 1]");
    option("--tolerance", tolerance, "TOL", "relative error [annotation experiment, else 1e-6]");
    option("--interval", interval, "H", "between rows of the result [annotation experiment, else a 500th of the run]");
    option("--integrator", integrator, "NAME", "auto, step, cvode or explicit [auto]");
    option("--stages", stages, "S", "stages of the step integrator, 1 to 4 [by tolerance]");
    option("--fixed-step", fixedStep, "H", "step integrator without error control");
    option("--longest-step", longestStep, "H", "no step is longer [as the errors allow]");
    option("--events", events, "both|after", "rows of the result at an event: before and after it, or after it [both]");
    option("-o,--output", output, "FILE", "result: .csv or .json");
    option("--variables", variables, "NAME",
           "variables of the result, by names in which * and ? stand for any characters (repeatable) [all]");
    option(
        "--sensitivity", sensitivities, "NAME",
        "derivatives of coordinates, velocities, states and outputs by a parameter, start or input as columns of the result (repeatable)");
    option("--event-log", eventLog, "FILE.csv", "one row for each event");
    app->add_flag("--check-invariants", checkInvariants,
                  "report the worst penetration, normal force, constraint residual and energy balance; fail where one is too large")
        ->disable_flag_override();
    app->add_flag("--quiet", quiet, "no summary, no progress")->disable_flag_override();
    app->add_flag("--verbose", verbose, "more about the run: every event, which integrators ran and why")->disable_flag_override();
    app->add_flag("--no-cache", noCache, "neither use nor store compiled code")->disable_flag_override();
  }

  Values input, interpolation, startTime, stopTime, tolerance, interval, integrator, stages, fixedStep, longestStep, events, output,
      eventLog, variables, sensitivities;
  bool quiet = false, verbose = false, noCache = false, checkInvariants = false;

  void finish(RunOptions &options, Reader &reader, Diagnostics &diagnostics) const {
    Syntax::finish(options, reader, diagnostics);
    options.inputTable = reader.name("--input", input);
    options.linearInput = reader.choice("--input-interpolation", interpolation, kInterpolations, false);
    options.startTime = reader.number("--start-time", startTime);
    options.stopTime = reader.number("--stop-time", stopTime);
    options.tolerance = reader.fraction("--tolerance", tolerance);
    options.interval = reader.positive("--interval", interval);
    options.integrator = reader.choice("--integrator", integrator, kIntegrators, TF_AUTO);
    options.stages = reader.integer("--stages", stages, 1, 4).value_or(0);
    options.fixedStep = reader.positive("--fixed-step", fixedStep).value_or(0);
    options.longestStep = reader.positive("--longest-step", longestStep).value_or(std::numeric_limits<double>::infinity());
    options.events = reader.choice("--events", events, kEventRows, EventRows::Both);
    options.output = reader.name("-o", output);
    options.eventLog = reader.name("--event-log", eventLog);
    options.quiet = quiet;
    options.verbose = verbose;
    options.noCache = noCache;
    options.checkInvariants = checkInvariants;
    for (const std::string &name : sensitivities)
      if (std::find(options.sensitivities.begin(), options.sensitivities.end(), name) == options.sensitivities.end())
        options.sensitivities.push_back(name);
    options.variables = variables;
    checkCombinations(options, diagnostics);
  }

private:
  static void checkCombinations(const RunOptions &options, Diagnostics &diagnostics) {
    if (options.linearInput && options.inputTable.empty())
      diagnostics.report(diag::OptionNeedsOption, {}, "--input-interpolation", "without --input");
    const bool otherIntegrator = options.integrator == TF_CVODE || options.integrator == TF_EXPLICIT;
    if (options.stages > 0 && otherIntegrator)
      diagnostics.report(diag::OptionNeedsOption, {}, "--stages", "with this integrator: it belongs to --integrator step");
    if (options.fixedStep > 0 && otherIntegrator)
      diagnostics.report(diag::OptionNeedsOption, {}, "--fixed-step", "with this integrator: it belongs to --integrator step");
    if (options.fixedStep > 0 && std::isfinite(options.longestStep))
      diagnostics.report(diag::OptionNeedsOption, {}, "--longest-step", "together with --fixed-step");
    if (!options.sensitivities.empty() && options.output.empty())
      diagnostics.report(diag::OptionNeedsOption, {}, "--sensitivity", "without -o: derivatives are columns of the result");
    if (options.quiet && options.verbose)
      diagnostics.report(diag::OptionNeedsOption, {}, "--quiet", "together with --verbose");
    if (isSameFile(options.output, options.eventLog))
      diagnostics.report(diag::SameFileTwice, {}, options.output, "with -o", "with --event-log");
    for (const auto &[output, option] : {std::pair(options.output, "with -o"), std::pair(options.eventLog, "with --event-log")}) {
      if (isSameFile(output, options.inputTable))
        diagnostics.report(diag::SameFileTwice, {}, output, "with --input", option);
      for (const std::string &file : options.files)
        if (isSameFile(output, file))
          diagnostics.report(diag::SameFileTwice, {}, output, "as the model", option);
    }
  }
};

struct CheckSyntax : Syntax {
  explicit CheckSyntax(CLI::App &parent) : Syntax(parent, "check", "report what is wrong with models, without running them") {}
};

// Words that start with a dash (numbers excepted) and are no option of the command.
void reportUnknownOptions(const CLI::App &app, Diagnostics &diagnostics) {
  Values known;
  for (const CLI::Option *option : app.get_options()) {
    for (const std::string &name : option->get_lnames())
      known.push_back("--" + name);
    for (const std::string &name : option->get_snames())
      known.push_back("-" + name);
  }
  for (const std::string &word : app.remaining()) {
    if (word == "--")  // files follow
      continue;
    const std::string name = word.substr(0, word.find('='));
    diagnostics.report(diag::UnknownOption, {}, name, app.get_name()).suggest(name, known);
  }
}

// CLI11 begins its messages with the option's name: "--stop-time: 1 required TEXT missing", "--quiet was given a disallowed flag override".
void reportValueCount(const CLI::Error &error, Diagnostics &diagnostics) {
  const std::string text = error.what();
  const bool isFlag = text.find("flag override") != std::string::npos;
  const std::string name = text.substr(0, text.find_first_of(": "));
  diagnostics.report(isFlag ? diag::SuperfluousValue : diag::MissingValue, {}, name.starts_with('-') ? name : "--" + name);
}

// Empty words are taken for no value, or for a name that nobody meant.
void reportEmptyValues(int argc, const char *const *argv, Diagnostics &diagnostics) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view before = argv[i - 1];
    if (argv[i][0] == '\0' && before.starts_with('-') && before != "-" && before != "--")
      diagnostics.report(diag::MissingValue, {}, before);
  }
}

void reportUnknownCommand(const CLI::App &app, Diagnostics &diagnostics) {
  const Values words = app.remaining();
  if (words.empty()) {
    diagnostics.report(diag::MissingCommand, {});
    return;
  }
  const std::string &word = words.front();
  const Values commands = {"check", "compile", "run", "--help", "--version"};
  diagnostics.report(diag::UnknownCommand, {}, word).suggest(word, commands);
}

}  // namespace

std::optional<CommandLine> parseCommandLine(int argc, const char *const *argv, Diagnostics &diagnostics) {
  CLI::App app(kDescription, "tfc");
  app.allow_extras();
  app.footer(kFooter);
  app.require_subcommand(0, 1);
  app.set_version_flag("--version", fmt::format("tfc {}", kVersion));
  const CheckSyntax check(app);
  const CompileSyntax compile(app);
  const RunSyntax run(app);

  reportEmptyValues(argc, argv, diagnostics);
  if (diagnostics.hasErrors())
    return std::nullopt;
  CommandLine result;
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForVersion &version) {
    result.text = std::string(version.what()) + "\n";
    return result;
  } catch (const CLI::Success &) {
    result.text = app.help();
    return result;
  } catch (const CLI::ParseError &error) {
    reportValueCount(error, diagnostics);
    return std::nullopt;
  }

  const auto given = app.get_subcommands();
  if (given.empty()) {
    reportUnknownCommand(app, diagnostics);
    return std::nullopt;
  }
  reportUnknownOptions(*given.front(), diagnostics);
  if (diagnostics.hasErrors())
    return std::nullopt;
  Reader reader(diagnostics);
  if (given.front() == check.app) {
    result.command = Command::Check;
    check.finish(result.check, reader, diagnostics);
  } else if (given.front() == compile.app) {
    result.command = Command::Compile;
    compile.finish(result.compile, reader, diagnostics);
  } else {
    result.command = Command::Run;
    run.finish(result.run, reader, diagnostics);
  }
  return diagnostics.hasErrors() ? std::nullopt : std::optional(std::move(result));
}

}  // namespace tf::driver
