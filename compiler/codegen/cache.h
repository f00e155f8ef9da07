// A cache of compiled models by content: shared libraries as files that the program can load without the code generator.
//
// Nothing here is an error to the user: an entry that is missing, damaged or cannot be written means that code is generated again.
#pragma once

#include "compiler/codegen/sha256.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tf {

// The key of an entry: a digest of everything that the code is made from. Parts are delimited, so that ("ab", "c") differs from ("a",
// "bc").
class CacheKey {
public:
  void add(std::string_view part);
  [[nodiscard]] std::string finish() { return digest_.finish(); }

private:
  Sha256 digest_;
};

// What the code generator makes of the host, known without it: architecture and capabilities of the processor.
[[nodiscard]] std::string hostIdentity();
// Path, size and time of change of a file: tells one build of a program or library from another. Of a missing file, the path.
[[nodiscard]] std::string fileIdentity(const std::string &path);

class CodeCache {
public:
  static constexpr std::uint64_t defaultCapacity = std::uint64_t{256} << 20U;  // bytes

  // In $TFC_CACHE_DIR (disabled if that is empty), else $XDG_CACHE_HOME/tfc, else $HOME/.cache/tfc.
  static CodeCache fromEnvironment();
  // An empty directory name disables it: nothing is found or stored.
  explicit CodeCache(std::string directory, std::uint64_t capacity = defaultCapacity);

  // The file of an intact entry; marks it as used now.
  [[nodiscard]] std::optional<std::string> find(const std::string &key) const;
  // Writes an entry, atomically for concurrent readers and writers, and removes the entries that were not used for longest beyond the
  // capacity. The entry's file; nothing if it cannot be written.
  std::optional<std::string> store(const std::string &key, std::string_view library) const;

private:
  [[nodiscard]] std::string fileOf(const std::string &key) const;
  void evict(const std::string &keep) const;

  std::string directory_;
  std::uint64_t capacity_;
};

}  // namespace tf
