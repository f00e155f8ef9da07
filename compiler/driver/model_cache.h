// Compiled models by content: a second run of the same source loads the shared library of the first one, without parser and code generator.
//
// Two kinds of files in the folder ($TFC_CACHE, else $XDG_CACHE_HOME/tfc, else ~/.cache/tfc):
//   KEY.index   what a request (files, --model, -L) depended on when it was compiled: every file that was read with the hash of its text,
//   the
//               folders in which classes were sought with the hash of their names, and the names of the structural parameters;
//   HASH.so     the model; HASH is over the texts, the structural values set, this build of tfc and this machine's processor.
// Files are written beside their place and renamed, so that several processes can share the folder.
#pragma once

#include "lang/base/source.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tf::driver {

// A request for a model, as far as the command line determines it.
struct CacheRequest {
  std::vector<std::string> files;
  std::string model;
  std::vector<std::string> libraries;       // with the standard library's folder
  std::map<std::string, double> overrides;  // of parameters; those that are structural count
};

class ModelCache {
public:
  // Without a folder (no home, not writable) nothing is found or stored.
  ModelCache();

  // The library of an earlier compilation whose inputs are all unchanged.
  [[nodiscard]] std::optional<std::filesystem::path> find(const CacheRequest &request) const;

  // Stores a model that was made from the texts in `sources`; its place, nothing if it cannot be written.
  std::optional<std::filesystem::path> store(const CacheRequest &request, const SourceManager &sources,
                                             const std::vector<std::string> &structuralNames, std::string_view library);

private:
  // What KEY.index holds.
  struct Index {
    std::map<std::string, std::string> files, folders;  // path to hash
    std::vector<std::string> structuralNames;
  };

  [[nodiscard]] std::filesystem::path indexPath(const CacheRequest &request) const;
  [[nodiscard]] std::filesystem::path libraryPath(const CacheRequest &request, const Index &index) const;
  static std::optional<Index> read(const std::filesystem::path &path);
  [[nodiscard]] bool write(const std::filesystem::path &path, std::string_view bytes) const;
  void removeOldest() const;

  std::filesystem::path folder_;  // empty: no cache
  std::string build_;             // hash of this program, its code generator and the processor
};

}  // namespace tf::driver
