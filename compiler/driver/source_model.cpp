#include "compiler/driver/source_model.h"
#include "compiler/driver/diagnostics.h"
#include "runtime/model/model_instance.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

namespace tf::driver {

namespace fs = std::filesystem;

namespace {

// Blanks mean nothing in names ("q[ 2 ]" is "q[2]").
std::string withoutBlanks(std::string_view text) {
  std::string result;
  std::copy_if(text.begin(), text.end(), std::back_inserter(result), [](unsigned char c) { return std::isspace(c) == 0; });
  return result;
}

std::string_view trimmed(std::string_view text) {
  const auto isBlank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && isBlank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back()))
    text.remove_suffix(1);
  return text;
}

std::optional<double> literal(std::string_view text) {
  if (text == "true" || text == "false")
    return text == "true" ? 1 : 0;
  if (text.starts_with('+'))
    text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool startsLikeANumber =
      !text.empty() && (text[0] == '-' || text[0] == '.' || std::isdigit(static_cast<unsigned char>(text[0])) != 0);
  return error == std::errc() && end == text.data() + text.size() && startsLikeANumber ? std::optional(value) : std::nullopt;
}

// Names in the file's folder that the user may have meant.
std::vector<std::string> neighbours(const fs::path &file) {
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::vector<Setting> parseSettings(const ModelOptions &options, Session &session) {
  std::vector<Setting> settings;
  for (const std::string &text : options.settings) {
    const std::size_t equals = text.find('=');
    const std::string name = withoutBlanks(std::string_view(text).substr(0, equals));
    const std::string_view value = equals == std::string::npos ? std::string_view() : trimmed(std::string_view(text).substr(equals + 1));
    if (name.empty() || value.empty()) {
      session.diagnostics.report(diag::BadSetting, {}, text);
      continue;
    }
    const auto same = std::find_if(settings.begin(), settings.end(), [&](const Setting &other) { return other.name == name; });
    if (same != settings.end())
      session.diagnostics.report(diag::RepeatedSetting, {}, name, same->value, value);
    else
      settings.push_back({name, std::string(value), literal(value)});
  }
  return settings;
}

bool checkReadable(const std::vector<std::string> &files, Session &session) {
  bool readable = true;
  for (const std::string &file : files) {
    std::error_code error;
    const bool isFolder = fs::is_directory(file, error);
    errno = 0;
    if (!isFolder && std::ifstream(file).good())
      continue;
    readable = false;
    const std::string reason = isFolder ? "it is a folder" : std::strerror(errno != 0 ? errno : EIO);
    Diagnostic &diagnostic = session.diagnostics.report(diag::CannotRead, {}, file, reason);
    if (!isFolder)
      diagnostic.suggest(fs::path(file).filename().string(), neighbours(file));
  }
  return readable;
}

bool checkLibraries(const ModelOptions &options, Session &session) {
  bool readable = true;
  for (const std::string &folder : options.libraries) {
    std::error_code error;
    if (fs::is_directory(folder, error))
      continue;
    readable = false;
    session.diagnostics.report(diag::CannotRead, {}, folder, error ? error.message() : "it is no folder");
  }
  return readable;
}

fs::path programPath() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error);
}

fs::path standardLibrary() {
  if (const char *given = std::getenv("TFC_STDLIB"); given != nullptr && *given != '\0')
    return given;
  const fs::path program = programPath().parent_path();
  std::error_code error;
  for (const char *relative : {"../share/tfc/stdlib", TFC_STDLIB_FROM_PROGRAM}) {
    if (const fs::path folder = (program / relative).lexically_normal(); fs::is_directory(folder, error))
      return folder;
  }
  return {};
}

std::vector<std::string> libraryFolders(const ModelOptions &options) {
  std::vector<std::string> folders = options.libraries;
  if (const fs::path standard = standardLibrary(); !standard.empty())
    folders.push_back(standard.string());
  return folders;
}

std::map<std::string, double> structuralOverrides(const std::vector<Setting> &settings) {
  std::map<std::string, double> overrides;
  for (const Setting &setting : settings) {
    if (setting.number)
      overrides[setting.name] = *setting.number;
  }
  return overrides;
}

void checkStructural(const flat::FlatModel &model, const std::vector<Setting> &settings, Session &session) {
  std::vector<std::string> names;
  for (const flat::Variable &variable : model.variables) {
    if (variable.isStructural)
      names.push_back(variable.name);
  }
  for (const Setting &setting : settings) {
    if (std::find(names.begin(), names.end(), setting.name) == names.end())
      session.diagnostics.report(diag::NotStructural, {}, setting.name, model.name).suggest(setting.name, names);
    else if (!setting.number)
      session.diagnostics.report(diag::NeedsConstant, {}, setting.name);
  }
}

void checkStructuralValues(const HybridSystem &system, const std::vector<Setting> &settings, Session &session) {
  for (const Setting &setting : settings) {
    const auto found = std::find_if(system.quantities.begin(), system.quantities.end(),
                                    [&](const Quantity &quantity) { return quantity.name == setting.name; });
    if (!setting.number || found == system.quantities.end() || (found->flags & TF_STRUCTURAL) == 0)
      continue;
    tf_variable described = {};
    described.kind = found->kind;
    described.flags = found->flags;
    described.min = found->min;
    described.max = found->max;
    if (const auto checked = runtime::ModelInstance::checkValue(described, *setting.number, setting.name); !checked)
      session.diagnostics.report(diag::RefusedSetting, {}, setting.name + "=" + setting.value, checked.error());
  }
}

bool isCompiledModel(const std::string &path) {
  std::array<char, 4> magic = {};
  return std::ifstream(path, std::ios::binary).read(magic.data(), magic.size()) && magic == std::array<char, 4>{'\x7f', 'E', 'L', 'F'};
}

Instantiation instantiateModel(const ModelOptions &options, const std::vector<Setting> &settings, Session &session) {
  InstantiateOptions front;
  front.model = options.model;
  front.libraries = libraryFolders(options);
  front.structuralOverrides = structuralOverrides(settings);
  Instantiation result = instantiate(session.sources, options.files, front, session.diagnostics);
  if (!result.model && !session.diagnostics.hasErrors())
    session.diagnostics.report(diag::SeveralModels, {}, fmt::format("{}", fmt::join(options.files, "', '")),
                               fmt::format("{}", fmt::join(result.candidates, ", ")));
  return result;
}

}  // namespace tf::driver
