#include "compiler/driver/prepared_model.h"
#include "compiler/driver/code_generator.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/model_cache.h"

#include <algorithm>
#include <exception>

namespace tf::driver {

namespace {

SimulationHandle load(const std::string &path, Session &session) {
  tf_simulation *simulation = nullptr;
  const tf_status status = tf_load(path.c_str(), &simulation);
  SimulationHandle handle(simulation);
  if (status == TF_OK)
    return handle;
  session.diagnostics.report(diag::NotACompiledModel, {}, handle ? tf_error_text(handle.get()) : "out of memory");
  return nullptr;
}

std::optional<PreparedModel> loadCompiled(const RunOptions &options, Session &session) {
  const auto &files = options.files;
  const auto compiled = std::find_if(files.begin(), files.end(), isCompiledModel);
  if (files.size() > 1) {
    session.diagnostics.report(diag::OnlyOneCompiledModel, {}, *compiled, compiled == files.begin() ? files[1] : files[0]);
    return std::nullopt;
  }
  PreparedModel prepared;
  prepared.simulation = load(*compiled, session);
  if (!prepared.simulation)
    return std::nullopt;
  prepared.origin = "loaded";
  if (!options.model.empty() && options.model != prepared.model().name) {
    session.diagnostics.report(diag::OptionNeedsOption, {}, "--model",
                               fmt::format("for '{}', which is the compiled model '{}'", *compiled, prepared.model().name));
    return std::nullopt;
  }
  return prepared;
}

std::vector<std::string> structuralNames(const flat::FlatModel &model) {
  std::vector<std::string> names;
  for (const flat::Variable &variable : model.variables) {
    if (variable.isStructural)
      names.push_back(variable.name);
  }
  return names;
}

// Generates code into the cache, or into memory where there is none.
bool generate(HybridSystem &system, const CacheRequest &request, const std::vector<std::string> &structural, const ModelCache *cache,
              PreparedModel &prepared, Session &session) {
  CodeGenerator *generator = codeGenerator(session);
  if (generator == nullptr)
    return false;
  const CodegenOptions codegen{.optimization = 2, .hash = sourceDigest(session.sources)};
  try {
    if (cache != nullptr) {
      const std::string library = generator->emit(system, session.sources, EmitKind::SharedLibrary, codegen);
      if (const auto path = cache->store(request, session.sources, structural, library)) {
        prepared.simulation = load(*path, session);
        return prepared.simulation != nullptr;
      }
    }
    prepared.code = generator->compileInMemory(system, session.sources, codegen);
  } catch (const std::exception &error) {
    session.diagnostics.report(diag::CannotGenerate, {}, error.what());
    return false;
  }
  tf_simulation *simulation = nullptr;
  const tf_status status = tf_create(prepared.code->model(), &simulation);
  prepared.simulation.reset(simulation);
  if (status != TF_OK)
    session.diagnostics.report(diag::NotACompiledModel, {}, tf_error_text(simulation));
  return status == TF_OK;
}

}  // namespace

std::optional<PreparedModel> prepareModel(const RunOptions &options, const std::vector<Setting> &settings, Session &session) {
  if (!checkReadable(options.files, session) || !checkLibraries(options, session))
    return std::nullopt;
  if (std::any_of(options.files.begin(), options.files.end(), isCompiledModel))
    return loadCompiled(options, session);

  PreparedModel prepared;
  prepared.isSource = true;
  const CacheRequest request{options.files, options.model, libraryFolders(options), structuralOverrides(settings)};
  const ModelCache cache(!options.noCache);
  if (const auto library = cache.find(request)) {
    prepared.simulation = load(*library, session);
    prepared.origin = "cached";
    return prepared.simulation ? std::optional(std::move(prepared)) : std::nullopt;
  }
  const Instantiation instantiation = instantiateModel(options, settings, session);
  if (!instantiation.model || session.diagnostics.hasErrors())
    return std::nullopt;
  auto system = derive(*instantiation.model, session.sources, session.diagnostics);
  if (!system || session.diagnostics.hasErrors())
    return std::nullopt;
  checkStructuralValues(*system, settings, session);
  if (session.diagnostics.hasErrors())
    return std::nullopt;
  prepared.origin = "compiled";
  if (!generate(*system, request, structuralNames(*instantiation.model), options.noCache ? nullptr : &cache, prepared, session))
    return std::nullopt;
  return prepared;
}

}  // namespace tf::driver
