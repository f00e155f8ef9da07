#include "compiler/codegen/cache.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#ifdef __x86_64__
#include <cpuid.h>
#endif

namespace tf {

namespace {

namespace fs = std::filesystem;

// Behind the library's bytes, which a loader does not look at: what tells a whole entry from a damaged one.
struct Trailer {
  std::array<char, 8> magic{'T', 'F', 'C', 'A', 'C', 'H', 'E', '1'};
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;
};

// FNV-1a on words of eight bytes: against damage, not against intent.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    hash = (hash ^ word) * 0x100000001b3ULL;
    hash ^= hash >> 29U;
  }
  return hash;
}

bool isIntact(std::string_view file) {
  Trailer trailer;
  if (file.size() < sizeof trailer)
    return false;
  const std::string_view library = file.substr(0, file.size() - sizeof trailer);
  std::memcpy(&trailer, file.data() + library.size(), sizeof trailer);
  return trailer.magic == Trailer{}.magic && trailer.size == library.size() && trailer.checksum == checksum(library);
}

// Empty if it is not a file that can be read.
std::string readFile(const std::string &path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return {};
  std::ifstream file(path, std::ios::binary);
  const std::uintmax_t size = fs::file_size(path, error);
  if (error)
    return {};
  std::string bytes(size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file ? bytes : std::string();
}

bool writeAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count <= 0)
      return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

std::string environment(const char *name) {
  const char *value = std::getenv(name);
  return value != nullptr ? value : "";
}

#ifdef __x86_64__
std::string processorCapabilities() {
  std::string text;
  const auto add = [&](unsigned leaf, unsigned subleaf, bool withB) {
    std::array<unsigned, 4> registers{};
    __get_cpuid_count(leaf, subleaf, &registers[0], &registers[1], &registers[2], &registers[3]);
    if (!withB)
      registers[1] = 0;  // of leaf 1: the number of the core that asks
    for (const unsigned value : registers)
      text += std::to_string(value) + ' ';
  };
  add(0, 0, true);
  add(1, 0, false);
  add(7, 0, true);
  add(7, 1, true);
  add(0xd, 1, true);
  add(0x80000001U, 0, true);
  return text;
}
#else
std::string processorCapabilities() {
  std::ifstream file("/proc/cpuinfo");
  std::string text;
  for (std::string line; std::getline(file, line) && !line.empty();)
    if (line.starts_with("Features") || line.starts_with("CPU ") || line.starts_with("isa"))
      text += line + '\n';
  return text;
}
#endif

}  // namespace

void CacheKey::add(std::string_view part) {
  digest_.update(std::to_string(part.size()) + ':');
  digest_.update(part);
}

std::string hostIdentity() { return processorCapabilities(); }

std::string fileIdentity(const std::string &path) {
  struct stat status{};
  if (stat(path.c_str(), &status) != 0)
    return path;
  return path + ' ' + std::to_string(status.st_size) + ' ' + std::to_string(status.st_mtim.tv_sec) + '.' +
         std::to_string(status.st_mtim.tv_nsec);
}

CodeCache CodeCache::fromEnvironment() {
  if (std::getenv("TFC_CACHE_DIR") != nullptr)
    return CodeCache(environment("TFC_CACHE_DIR"));
  if (const std::string base = environment("XDG_CACHE_HOME"); base.starts_with('/'))
    return CodeCache(base + "/tfc");
  if (const std::string home = environment("HOME"); home.starts_with('/'))
    return CodeCache(home + "/.cache/tfc");
  return CodeCache("");
}

CodeCache::CodeCache(std::string directory, std::uint64_t capacity) : directory_(std::move(directory)), capacity_(capacity) {}

std::string CodeCache::fileOf(const std::string &key) const { return directory_ + '/' + key + ".so"; }

std::optional<std::string> CodeCache::find(const std::string &key) const {
  if (directory_.empty())
    return std::nullopt;
  std::string path = fileOf(key);
  if (!isIntact(readFile(path)))
    return std::nullopt;
  utimensat(AT_FDCWD, path.c_str(), nullptr, 0);
  return path;
}

std::optional<std::string> CodeCache::store(const std::string &key, std::string_view library) const {
  Trailer trailer;
  if (directory_.empty() || library.size() + sizeof trailer > capacity_)
    return std::nullopt;
  std::error_code error;
  fs::create_directories(directory_, error);
  std::string temporary = directory_ + "/new-XXXXXX";
  const int descriptor = mkstemp(temporary.data());
  if (descriptor < 0)
    return std::nullopt;
  trailer.size = library.size();
  trailer.checksum = checksum(library);
  std::array<char, sizeof trailer> end{};
  std::memcpy(end.data(), &trailer, sizeof trailer);
  bool written = writeAll(descriptor, library) && writeAll(descriptor, {end.data(), end.size()});
  written = close(descriptor) == 0 && written;
  std::string path = fileOf(key);
  if (!written || rename(temporary.c_str(), path.c_str()) != 0) {
    unlink(temporary.c_str());
    return std::nullopt;
  }
  evict(path);
  return path;
}

// Also removes what an interrupted writer left behind.
void CodeCache::evict(const std::string &keep) const {
  struct Entry {
    fs::file_time_type used;
    std::uint64_t size;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uint64_t total = 0;
  std::error_code error;
  const auto now = fs::file_time_type::clock::now();
  for (auto file = fs::directory_iterator(directory_, error); !error && file != fs::directory_iterator(); file.increment(error)) {
    std::error_code gone;
    const fs::path &path = file->path();
    const Entry entry{file->last_write_time(gone), file->file_size(gone), path};
    if (gone)
      continue;
    if (path.extension() == ".so") {
      total += entry.size;
      entries.push_back(entry);
    } else if (path.filename().string().starts_with("new-") && now - entry.used > std::chrono::hours(1)) {
      fs::remove(path, gone);
    }
  }
  std::sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) { return a.used < b.used; });
  for (const Entry &entry : entries) {
    if (total <= capacity_)
      return;
    if (entry.path != keep && fs::remove(entry.path, error))
      total -= entry.size;
  }
}

}  // namespace tf
