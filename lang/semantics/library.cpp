#include "lang/semantics/library.h"

#include "lang/semantics/diagnostics.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

namespace tf::semantics {

namespace fs = std::filesystem;

namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string folderOf(const std::string &path) {
  const std::string parent = fs::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

const ast::ClassDefinition *classOf(const ast::File *file, std::string_view name) {
  if (file == nullptr)
    return nullptr;
  const auto found = std::find_if(file->classes.begin(), file->classes.end(),
                                  [&](const ast::ClassDefinition *entry) { return entry != nullptr && entry->name.text == name; });
  return found == file->classes.end() ? nullptr : *found;
}

constexpr std::array<std::string_view, 2> kSuffixes = {".tf", ".mo"};

}  // namespace

Library::Library(SourceManager &sources, Diagnostics &diagnostics, const std::vector<std::string> &folders)
    : sources_(sources), diagnostics_(diagnostics), folders_(folders) {}

const ast::File *Library::parse(const std::string &path) {
  std::error_code error;
  const std::string key = fs::weakly_canonical(path, error).string();
  if (const auto known = parsed_.find(key); known != parsed_.end())
    return known->second;
  const std::optional<FileId> file = sources_.load(path);
  if (!file)
    return nullptr;
  paths_.push_back(path);
  trees_.push_back(ast::parseFile(sources_, *file, diagnostics_));
  return parsed_[key] = trees_.back().file;
}

const ast::File *Library::addGiven(const std::string &path) {
  const ast::File *file = parse(path);
  if (file == nullptr) {
    diagnostics_.report(diag::CannotRead, Span{}, path);
    return nullptr;
  }
  given_.push_back(file);
  std::string folder = folderOf(path);
  for (std::size_t level = 0; file->hasWithin && level < file->within.parts.size(); ++level)
    folder = folderOf(folder);
  const auto at = folders_.begin() + static_cast<std::ptrdiff_t>(std::min(folders_.size(), given_.size() - 1));
  if (std::find(folders_.begin(), at, folder) == at)
    folders_.insert(at, folder);
  for (const ast::ClassDefinition *definition : file->classes) {
    if (definition == nullptr || (file->hasWithin && !file->within.parts.empty()))
      continue;
    const auto [entry, isNew] = topLevel_.emplace(std::string(definition->name.text), definition);
    if (!isNew)
      diagnostics_.report(diag::DeclaredTwice, definition->name.span, definition->name.text)
          .note(entry->second->name.span, "first declared here");
    const std::string stem = lower(fs::path(path).filename().string());
    if (stem == "package.tf" || stem == "package.mo")
      packageFolders_[definition] = folder;
  }
  return file;
}

const std::map<std::string, std::vector<std::string>> &Library::entries(const std::string &folder) {
  const auto [entry, isNew] = listings_.try_emplace(folder);
  if (!isNew)
    return entry->second;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    entry->second[lower(name)].push_back(name);
  }
  for (auto &[key, names] : entry->second)
    std::ranges::sort(names);
  return entry->second;
}

const ast::ClassDefinition *Library::searchFolder(const std::string &folder, std::string_view name) {
  const auto &listing = entries(folder);
  const std::string key = lower(name);
  const auto pick = [&](const std::string &entry) -> std::string {
    const auto found = listing.find(entry);
    return found == listing.end() ? std::string() : (fs::path(folder) / found->second.front()).lexically_normal().string();
  };
  std::error_code error;
  for (const std::string_view suffix : kSuffixes) {
    const std::string path = pick(key + std::string(suffix));
    if (path.empty() || !fs::is_regular_file(path, error))
      continue;
    if (const ast::ClassDefinition *definition = classOf(parse(path), name))
      return definition;
  }
  const std::string sub = pick(key);
  if (sub.empty() || !fs::is_directory(sub, error))
    return nullptr;
  const auto &inner = entries(sub);
  for (const std::string_view suffix : kSuffixes) {
    const auto found = inner.find("package" + std::string(suffix));
    if (found == inner.end())
      continue;
    const std::string path = (fs::path(sub) / found->second.front()).string();
    const ast::ClassDefinition *definition = classOf(parse(path), name);
    if (definition != nullptr)
      packageFolders_[definition] = sub;
    return definition;
  }
  return nullptr;
}

const ast::ClassDefinition *Library::findTopLevel(std::string_view name) {
  const auto [entry, isNew] = topLevel_.try_emplace(std::string(name), nullptr);
  if (!isNew)
    return entry->second;
  for (const std::string &folder : folders_)
    if (const ast::ClassDefinition *definition = searchFolder(folder, name))
      return entry->second = definition;
  return nullptr;
}

const ast::ClassDefinition *Library::findInPackage(const ast::ClassDefinition &package, std::string_view name) {
  const auto folder = packageFolders_.find(&package);
  return folder == packageFolders_.end() ? nullptr : searchFolder(folder->second, name);
}

std::vector<std::string> Library::topLevelNames() const {
  std::vector<std::string> names;
  for (const auto &[name, definition] : topLevel_)
    if (definition != nullptr)
      names.push_back(name);
  return names;
}

bool Library::isGiven(const ast::ClassDefinition &definition) const {
  return std::ranges::any_of(given_, [&](const ast::File *file) {
    return std::any_of(file->classes.begin(), file->classes.end(), [&](const ast::ClassDefinition *entry) { return entry == &definition; });
  });
}

}  // namespace tf::semantics
