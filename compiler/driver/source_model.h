// The front end's part of a command: from the named files to a derived system.
#pragma once

#include "compiler/driver/options.h"
#include "compiler/driver/session.h"
#include "compiler/mechanics/hybrid_system.h"
#include "lang/semantics/instantiate.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tf::driver {

// One `--set name=value`, its name without blanks.
struct Setting {
  std::string name, value;
  std::optional<double> number;  // where the value is a number, true or false
};

// In order of the command line. Wrong forms and repetitions are reported.
[[nodiscard]] std::vector<Setting> parseSettings(const ModelOptions &options, Session &session);

// Reports files that cannot be read; false if there are any.
bool checkReadable(const std::vector<std::string> &files, Session &session);
// The same for the folders of -L.
bool checkLibraries(const ModelOptions &options, Session &session);

// The standard library's folder: $TFC_STDLIB, else beside the program (share/tfc/stdlib when installed).
[[nodiscard]] std::filesystem::path standardLibrary();
// The program itself; codegen and standard library are found from there.
[[nodiscard]] std::filesystem::path programPath();

// -L folders, then the standard library's.
[[nodiscard]] std::vector<std::string> libraryFolders(const ModelOptions &options);

// The values that structural parameters take.
[[nodiscard]] std::map<std::string, double> structuralOverrides(const std::vector<Setting> &settings);

// `tfc compile` can take settings of structural parameters only: reports others.
void checkStructural(const flat::FlatModel &model, const std::vector<Setting> &settings, Session &session);

// Whether they may take these values: reports those out of bounds, or that are not whole or no truth values.
void checkStructuralValues(const HybridSystem &system, const std::vector<Setting> &settings, Session &session);

// The file is a shared library rather than a text.
[[nodiscard]] bool isCompiledModel(const std::string &path);

// Parses, instantiates and types. Reports also when there is not exactly one model and none was named.
[[nodiscard]] Instantiation instantiateModel(const ModelOptions &options, const std::vector<Setting> &settings, Session &session);

}  // namespace tf::driver
