#include "compiler/driver/check.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/source_model.h"

#include <algorithm>

namespace tf::driver {

namespace {

std::string counted(std::size_t count, const char *singular, const char *plural) {
  return fmt::format("{} {}", count, count == 1 ? singular : plural);
}

std::string sizes(const HybridSystem &system) {
  const auto size = [](int n) { return static_cast<std::size_t>(n); };
  return fmt::format("{}: {}, {}, {}, {}, {}, {}, {}\n", system.name, counted(size(system.nq), "coordinate", "coordinates"),
                     counted(size(system.nz), "state", "states"), counted(size(system.nu), "input", "inputs"),
                     counted(size(system.np), "parameter", "parameters"), counted(system.contacts.size(), "contact", "contacts"),
                     counted(system.frictions.size(), "friction element", "friction elements"),
                     counted(system.switches.size(), "switch", "switches"));
}

void checkModel(const flat::FlatModel &model, const std::vector<Setting> &settings, Session &session) {
  const auto system = derive(model, session.sources, session.diagnostics);
  if (system)
    checkStructuralValues(*system, settings, session);
  if (system && !session.diagnostics.hasErrors())
    printOut(sizes(*system), session);
}

}  // namespace

int checkCommand(const CheckOptions &options, Session &session) {
  if (!checkReadable(options.files, session) || !checkLibraries(options, session))
    return session.exitCode();
  for (const std::string &file : options.files) {
    if (isCompiledModel(file))
      session.diagnostics.report(diag::SourceNeeded, {}, file, "check");
  }
  const std::vector<Setting> settings = parseSettings(options, session);
  if (session.diagnostics.hasErrors())
    return session.exitCode();
  InstantiateOptions front{options.model, libraryFolders(options), structuralOverrides(settings)};
  const Instantiation first = instantiate(session.sources, options.files, front, session.diagnostics);
  if (first.model)
    checkModel(*first.model, settings, session);
  else if (!session.diagnostics.hasErrors()) {
    for (const std::string &candidate : first.candidates) {
      front.model = candidate;
      const Instantiation instantiation = instantiate(session.sources, options.files, front, session.diagnostics);
      if (instantiation.model)
        checkModel(*instantiation.model, settings, session);
    }
  }
  return session.exitCode();
}

}  // namespace tf::driver
