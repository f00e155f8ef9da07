#include "compiler/driver/model_cache.h"
#include "compiler/driver/source_model.h"
#include "compiler/driver/version.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace tf::driver {

namespace fs = std::filesystem;

namespace {

constexpr const char *kIndexHeader = "tfc index 1";
constexpr const char *kIndexEnd = "end";  // the cache's own bytes follow

std::string digest(std::string_view text) {
  Sha256 digest;
  digest.update(text);
  return digest.finish();
}

std::string fileDigest(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  return file ? digest(std::string(std::istreambuf_iterator<char>(file), {})) : std::string();
}

// Over the names that a class could be found under: sources, and folders that are packages.
std::string folderDigest(const std::string &folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    const bool isPackage = fs::exists(entry->path() / "package.mo", error) || fs::exists(entry->path() / "package.tf", error);
    if (extension == ".tf" || extension == ".mo" || isPackage)
      names.push_back(entry->path().filename().string() + '\n');
  }
  std::sort(names.begin(), names.end());
  Sha256 digest;
  for (const std::string &name : names)
    digest.update(name);
  return digest.finish();
}

std::string absolute(const std::string &path) {
  std::error_code error;
  return fs::absolute(path, error).lexically_normal().string();
}

std::string buildIdentity() {
  const fs::path program = programPath();
  std::string identity = fmt::format("{}\n{}\n", kVersion, fileIdentity(program.string()));
  for (const char *library : {"libtfcodegen.so", "../lib/libtfcodegen.so"})
    identity += fileIdentity((program.parent_path() / library).string()) + "\n";
  return identity + hostIdentity();
}

}  // namespace

std::string sourceDigest(const SourceManager &sources) {
  CacheKey key;
  for (FileId file = 0; file < sources.count(); ++file)
    key.add(sources.file(file).text());
  return key.finish();
}

ModelCache::ModelCache(bool isEnabled)
    : cache_(isEnabled ? CodeCache::fromEnvironment() : CodeCache("")), build_(isEnabled ? buildIdentity() : "") {}

CacheKey ModelCache::requestKey(const CacheRequest &request) const {
  CacheKey key;
  key.add(build_);
  key.add(request.model);
  for (const std::string &file : request.files) {  // as given too: messages of the compiled model name files that way
    key.add(file);
    key.add(absolute(file));
  }
  for (const std::string &library : request.libraries)
    key.add(absolute(library));
  return key;
}

std::string ModelCache::modelKey(const CacheRequest &request, const Index &index) const {
  CacheKey key = requestKey(request);
  key.add("model");
  for (const auto &[path, text] : index.files) {
    key.add(path);
    key.add(text);
  }
  for (const auto &[name, value] : request.overrides) {
    if (std::binary_search(index.structuralNames.begin(), index.structuralNames.end(), name))
      key.add(fmt::format("{}={}", name, value));
  }
  return key.finish();
}

std::string ModelCache::print(const Index &index) {
  std::string text = fmt::format("{}\n", kIndexHeader);
  for (const auto &[path, hash] : index.files)
    text += fmt::format("file {} {}\n", hash, path);
  for (const auto &[path, hash] : index.folders)
    text += fmt::format("folder {} {}\n", hash, path);
  for (const std::string &name : index.structuralNames)
    text += fmt::format("structural - {}\n", name);
  return text + kIndexEnd + "\n";
}

std::optional<ModelCache::Index> ModelCache::findIndex(const CacheRequest &request) const {
  const auto path = cache_.find(requestKey(request).finish());
  if (!path)
    return std::nullopt;
  std::ifstream file(*path);
  std::string line;
  if (!std::getline(file, line) || line != kIndexHeader)
    return std::nullopt;
  Index index;
  while (std::getline(file, line) && line != kIndexEnd) {
    const std::size_t first = line.find(' '), second = line.find(' ', first + 1);
    if (second == std::string::npos)
      return std::nullopt;
    const std::string kind = line.substr(0, first), name = line.substr(second + 1);
    if (kind == "structural")
      index.structuralNames.push_back(name);
    else
      (kind == "file" ? index.files : index.folders)[name] = line.substr(first + 1, second - first - 1);
  }
  return index;
}

std::optional<std::string> ModelCache::find(const CacheRequest &request) const {
  const auto index = findIndex(request);
  if (!index)
    return std::nullopt;
  for (const auto &[path, text] : index->files) {
    if (fileDigest(path) != text)
      return std::nullopt;
  }
  for (const auto &[path, names] : index->folders) {
    if (folderDigest(path) != names)
      return std::nullopt;
  }
  return cache_.find(modelKey(request, *index));
}

std::optional<std::string> ModelCache::store(const CacheRequest &request, const SourceManager &sources,
                                             const std::vector<std::string> &structuralNames, std::string_view library) const {
  Index index;
  if (const auto earlier = findIndex(request))  // another structure of the model may have more structural parameters
    index.structuralNames = earlier->structuralNames;
  for (FileId file = 0; file < sources.count(); ++file)
    index.files[absolute(sources.file(file).path())] = digest(sources.file(file).text());
  for (const std::string &file : request.files) {
    const std::string folder = fs::path(absolute(file)).parent_path().string();
    index.folders[folder] = folderDigest(folder);
  }
  for (const std::string &folder : request.libraries)
    index.folders[absolute(folder)] = folderDigest(folder);
  std::vector<std::string> &names = index.structuralNames;
  names.insert(names.end(), structuralNames.begin(), structuralNames.end());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());

  const auto place = cache_.store(modelKey(request, index), library);
  if (place)
    static_cast<void>(cache_.store(requestKey(request).finish(), print(index)));  // without it the next run compiles again
  return place;
}

}  // namespace tf::driver
