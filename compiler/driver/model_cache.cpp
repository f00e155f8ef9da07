#include "compiler/driver/model_cache.h"
#include "compiler/driver/content_hash.h"
#include "compiler/driver/source_model.h"
#include "compiler/driver/version.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sys/auxv.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace tf::driver {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostLibraries = 500;
constexpr const char *kIndexHeader = "tfc cache index 1";

fs::path cacheFolder() {
  const auto variable = [](const char *name) {
    const char *value = std::getenv(name);
    return fs::path(value == nullptr ? "" : value);
  };
  if (const fs::path given = variable("TFC_CACHE"); !given.empty())
    return given;
  if (const fs::path cache = variable("XDG_CACHE_HOME"); cache.is_absolute())
    return cache / "tfc";
  if (const fs::path home = variable("HOME"); home.is_absolute())
    return home / ".cache" / "tfc";
  return {};
}

void addFile(ContentHash &hash, const fs::path &path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) == 0) {
    hash.add(static_cast<std::uint64_t>(status.st_size)).add(static_cast<std::uint64_t>(status.st_mtim.tv_sec));
    hash.add(static_cast<std::uint64_t>(status.st_mtim.tv_nsec));
  }
}

// Instructions that generated code may use on this machine.
void addProcessor(ContentHash &hash) {
  hash.add(static_cast<std::uint64_t>(getauxval(AT_HWCAP))).add(static_cast<std::uint64_t>(getauxval(AT_HWCAP2)));
#if defined(__x86_64__)
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid(1, &a, &b, &c, &d) != 0)  // family, model and stepping; features
    hash.add(std::uint64_t{a}).add(std::uint64_t{c}).add(std::uint64_t{d});
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) != 0)
    hash.add(std::uint64_t{b}).add(std::uint64_t{c}).add(std::uint64_t{d});
#endif
}

std::string buildIdentity() {
  ContentHash hash;
  const fs::path program = programPath();
  hash.add(kVersion);
  addFile(hash, program);
  for (const char *library : {"libtfcodegen.so", "../lib/libtfcodegen.so"})
    addFile(hash, program.parent_path() / library);
  addProcessor(hash);
  return hash.hex();
}

std::optional<std::string> readText(const fs::path &path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

std::optional<std::string> fileHash(const fs::path &path) {
  const auto text = readText(path);
  return text ? std::optional(ContentHash().add(*text).hex()) : std::nullopt;
}

// Over the names that a class could be found under: sources and folders.
std::string folderHash(const fs::path &folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension == ".tf" || extension == ".mo" || entry->is_directory(error))
      names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  ContentHash hash;
  for (const std::string &name : names)
    hash.add(name);
  return hash.hex();
}

std::string absolute(const std::string &path) {
  std::error_code error;
  return fs::absolute(path, error).lexically_normal().string();
}

}  // namespace

ModelCache::ModelCache() : folder_(cacheFolder()) {
  std::error_code error;
  if (!folder_.empty())
    fs::create_directories(folder_, error);
  if (error || (!folder_.empty() && access(folder_.c_str(), W_OK | X_OK) != 0))
    folder_.clear();
  if (!folder_.empty())
    build_ = buildIdentity();
}

fs::path ModelCache::indexPath(const CacheRequest &request) const {
  ContentHash hash;
  hash.add(build_).add(request.model);
  for (const std::string &file : request.files)  // as given too: messages of the compiled model name files that way
    hash.add(file).add(absolute(file));
  for (const std::string &library : request.libraries)
    hash.add(absolute(library));
  return folder_ / (hash.hex() + ".index");
}

fs::path ModelCache::libraryPath(const CacheRequest &request, const Index &index) const {
  ContentHash hash;
  hash.add(build_).add(request.model);
  for (const std::string &file : request.files)
    hash.add(file);
  for (const auto &[path, text] : index.files)
    hash.add(path).add(text);
  for (const auto &[name, value] : request.overrides) {
    if (std::binary_search(index.structuralNames.begin(), index.structuralNames.end(), name))
      hash.add(name).add(std::bit_cast<std::uint64_t>(value));
  }
  return folder_ / (hash.hex() + ".so");
}

// Lines "file HASH PATH", "folder HASH PATH", "structural NAME" after the header.
std::optional<ModelCache::Index> ModelCache::read(const fs::path &path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line != kIndexHeader)
    return std::nullopt;
  Index index;
  while (std::getline(file, line)) {
    const std::size_t first = line.find(' '), second = line.find(' ', first + 1);
    const std::string kind = line.substr(0, first);
    if (first == std::string::npos || (kind != "structural" && second == std::string::npos))
      return std::nullopt;
    if (kind == "structural")
      index.structuralNames.push_back(line.substr(first + 1));
    else
      (kind == "file" ? index.files : index.folders)[line.substr(second + 1)] = line.substr(first + 1, second - first - 1);
  }
  return index;
}

std::optional<fs::path> ModelCache::find(const CacheRequest &request) const {
  if (folder_.empty())
    return std::nullopt;
  const auto index = read(indexPath(request));
  if (!index)
    return std::nullopt;
  const bool isUnchanged =
      std::all_of(index->files.begin(), index->files.end(), [](const auto &file) { return fileHash(file.first) == file.second; }) &&
      std::all_of(index->folders.begin(), index->folders.end(),
                  [](const auto &folder) { return folderHash(folder.first) == folder.second; });
  const fs::path library = libraryPath(request, *index);
  std::error_code error;
  return isUnchanged && fs::exists(library, error) ? std::optional(library) : std::nullopt;
}

std::optional<fs::path> ModelCache::store(const CacheRequest &request, const SourceManager &sources,
                                          const std::vector<std::string> &structuralNames, std::string_view library) {
  if (folder_.empty())
    return std::nullopt;
  Index index = read(indexPath(request)).value_or(Index{});
  index.files.clear();
  index.folders.clear();
  for (FileId file = 0; file < sources.count(); ++file)
    index.files[absolute(sources.file(file).path())] = ContentHash().add(sources.file(file).text()).hex();
  for (const std::string &file : request.files) {
    const std::string folder = fs::path(absolute(file)).parent_path().string();
    index.folders[folder] = folderHash(folder);
  }
  for (const std::string &folder : request.libraries)
    index.folders[absolute(folder)] = folderHash(folder);
  index.structuralNames.insert(index.structuralNames.end(), structuralNames.begin(), structuralNames.end());
  std::sort(index.structuralNames.begin(), index.structuralNames.end());
  index.structuralNames.erase(std::unique(index.structuralNames.begin(), index.structuralNames.end()), index.structuralNames.end());

  std::string text = fmt::format("{}\n", kIndexHeader);
  for (const auto &[path, hash] : index.files)
    text += fmt::format("file {} {}\n", hash, path);
  for (const auto &[path, hash] : index.folders)
    text += fmt::format("folder {} {}\n", hash, path);
  for (const std::string &name : index.structuralNames)
    text += fmt::format("structural {}\n", name);
  const fs::path place = libraryPath(request, index);
  if (!write(place, library) || !write(indexPath(request), text))
    return std::nullopt;
  removeOldest();
  return place;
}

bool ModelCache::write(const fs::path &path, std::string_view bytes) const {
  const fs::path beside = fmt::format("{}.{}", path.string(), getpid());
  std::error_code error;
  {
    std::ofstream file(beside, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
      fs::remove(beside, error);
      return false;
    }
  }
  fs::rename(beside, path, error);
  return !error;
}

void ModelCache::removeOldest() const {
  std::vector<std::pair<fs::file_time_type, fs::path>> libraries;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".so")
      libraries.emplace_back(entry->last_write_time(error), entry->path());
  }
  if (libraries.size() <= kMostLibraries)
    return;
  std::sort(libraries.begin(), libraries.end());
  libraries.resize(libraries.size() - kMostLibraries);
  for (const auto &[time, path] : libraries)
    fs::remove(path, error);
}

}  // namespace tf::driver
