// Compiled models by request: a second run of the same source loads the shared library of the first one, without parser and code generator.
//
// Two kinds of entries in the cache of compiled code. A request (files, --model, -L) names an index: every file that was read with the
// digest of its text, the folders in which classes were sought with the digest of their names, and the names of the structural parameters.
// These, the structural values set, this build of tfc and this machine's processor name the model.
#pragma once

#include "compiler/codegen/cache.h"
#include "lang/base/source.h"

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

// The digest of all texts that were read: what a compiled model says that it was made from.
[[nodiscard]] std::string sourceDigest(const SourceManager &sources);

class ModelCache {
public:
  // Disabled: nothing is found or stored.
  explicit ModelCache(bool isEnabled);

  // The library of an earlier compilation whose inputs are all unchanged.
  [[nodiscard]] std::optional<std::string> find(const CacheRequest &request) const;

  // Stores a model that was made from the texts in `sources`; its file, nothing if it cannot be written.
  std::optional<std::string> store(const CacheRequest &request, const SourceManager &sources,
                                   const std::vector<std::string> &structuralNames, std::string_view library) const;

private:
  struct Index {
    std::map<std::string, std::string> files, folders;  // absolute path to digest
    std::vector<std::string> structuralNames;           // sorted
  };

  [[nodiscard]] CacheKey requestKey(const CacheRequest &request) const;
  [[nodiscard]] std::string modelKey(const CacheRequest &request, const Index &index) const;
  [[nodiscard]] std::optional<Index> findIndex(const CacheRequest &request) const;
  static std::string print(const Index &index);

  CodeCache cache_;
  std::string build_;  // this program, its code generator and the processor
};

}  // namespace tf::driver
