#include "compiler/driver/compile.h"
#include "compiler/codegen/c_header.h"
#include "compiler/driver/code_generator.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/model_cache.h"
#include "compiler/driver/same_file.h"
#include "compiler/driver/source_model.h"
#include "compiler/filippov/filippov_system.h"
#include "lang/syntax/parser.h"
#include "runtime/results/output_file.h"

#include <algorithm>
#include <exception>

namespace tf::driver {

namespace {

std::optional<EmitKind> codeKind(Emit emit) {
  switch (emit) {
  case Emit::LlvmIr:
    return EmitKind::LlvmIr;
  case Emit::Assembly:
    return EmitKind::Assembly;
  case Emit::Object:
    return EmitKind::Object;
  case Emit::Shared:
    return EmitKind::SharedLibrary;
  default:
    return std::nullopt;
  }
}

// The syntax trees of the files, as far as they can be parsed.
std::string syntaxTrees(const CompileOptions &options, Session &session) {
  std::string text;
  for (const std::string &path : options.files) {
    const auto file = session.sources.load(path);
    if (!file)
      continue;
    const ast::Tree tree = ast::parseFile(session.sources, *file, session.diagnostics);
    text += ast::print(*tree.file);
  }
  return text;
}

std::string code(HybridSystem &system, const CompileOptions &options, EmitKind kind, Session &session) {
  CodeGenerator *generator = codeGenerator(session);
  if (generator == nullptr)
    return {};
  try {
    return generator->emit(system, session.sources, kind, {.optimization = options.optimization, .hash = sourceDigest(session.sources)});
  } catch (const std::exception &error) {
    session.diagnostics.report(diag::CannotGenerate, {}, error.what());
    return {};
  }
}

std::string form(HybridSystem &system, const CompileOptions &options, Session &session) {
  if (const auto kind = codeKind(options.emit))
    return code(system, options, *kind, session);
  if (options.emit == Emit::Header)
    return emitHeader(system);
  writeOutMatrices(system);
  if (options.emit == Emit::Cls)
    return print(system);
  const filippov::FilippovSystem frozen = filippov::timeFreezing(system);
  if (options.emit == Emit::Pss)
    return printPiecewise(frozen, system);
  return options.emit == Emit::Stewart ? printStewart(frozen, system) : printStep(frozen, system);
}

// What a form is called in the current folder; texts go to the standard output.
std::string defaultOutput(const std::string &model, Emit emit) {
  const std::string simple = model.substr(model.rfind('.') + 1);
  if (emit == Emit::Shared)
    return simple + ".so";
  return emit == Emit::Object ? simple + ".o" : "-";
}

void writeOutput(const std::string &path, std::string_view bytes, Session &session) {
  if (path == "-") {
    printOut(bytes, session);
    return;
  }
  auto file = runtime::OutputFile::create(path);
  if (!file) {
    session.diagnostics.report(diag::CannotWrite, {}, file.error());
    return;
  }
  auto written = file.value().write(bytes);
  if (written)
    written = file.value().close();
  if (!written)
    session.diagnostics.report(diag::CannotWrite, {}, written.error());
}

// A source may not be overwritten by what is made of it.
bool isSourceFile(const std::string &output, const CompileOptions &options) {
  return std::any_of(options.files.begin(), options.files.end(), [&](const std::string &file) { return isSameFile(file, output); });
}

}  // namespace

int compileCommand(const CompileOptions &options, Session &session) {
  if (!checkReadable(options.files, session) || !checkLibraries(options, session))
    return session.exitCode();
  for (const std::string &file : options.files) {
    if (isCompiledModel(file))
      session.diagnostics.report(diag::SourceNeeded, {}, file, "compile");
  }
  if (isSourceFile(options.output, options))
    session.diagnostics.report(diag::SameFileTwice, {}, options.output, "as the source", "with -o");
  const std::vector<Setting> settings = parseSettings(options, session);
  if (session.diagnostics.hasErrors())
    return session.exitCode();

  std::string name, text;
  if (options.emit == Emit::Ast) {
    text = syntaxTrees(options, session);
  } else {
    const Instantiation instantiation = instantiateModel(options, settings, session);
    if (!instantiation.model || session.diagnostics.hasErrors())
      return session.exitCode();
    checkStructural(*instantiation.model, settings, session);
    name = instantiation.model->name;
    if (options.emit == Emit::Flat) {
      text = print(*instantiation.model);
    } else if (auto system = derive(*instantiation.model, session.sources, session.diagnostics);
               system && !session.diagnostics.hasErrors()) {
      checkStructuralValues(*system, settings, session);
      text = form(*system, options, session);
    }
  }
  const bool isPartial = options.emit == Emit::Ast;  // the tree of a wrong text is worth showing
  if (!session.diagnostics.hasErrors() || isPartial)
    writeOutput(options.output.empty() ? defaultOutput(name, options.emit) : options.output, text, session);
  return session.exitCode();
}

}  // namespace tf::driver
