// The files of an instantiation: those that were given, and library files read on demand (language.md section 4, "Files").
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/syntax/parser.h"

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tf::semantics {

class Library {
public:
  Library(SourceManager &sources, Diagnostics &diagnostics, const std::vector<std::string> &folders);

  // Parses a given file; nothing if it cannot be read (reported).
  const ast::File *addGiven(const std::string &path);

  // A top-level name: a class of a given file, else the file `name.tf|.mo` or the folder `name/package.tf|.mo` beside the given files or in
  // the library folders. Null if there is none.
  const ast::ClassDefinition *findTopLevel(std::string_view name);

  // A class of the package `package` (its dotted name, "" for the root) that is stored in a file of its own beside its package.tf.
  const ast::ClassDefinition *findInPackage(const ast::ClassDefinition &package, std::string_view name);

  // Names of top-level classes in the given files.
  [[nodiscard]] std::vector<std::string> topLevelNames() const;
  [[nodiscard]] const std::vector<const ast::File *> &given() const { return given_; }
  [[nodiscard]] const std::vector<std::string> &files() const { return paths_; }
  [[nodiscard]] bool isGiven(const ast::ClassDefinition &definition) const;

private:
  const ast::File *parse(const std::string &path);
  const ast::ClassDefinition *searchFolder(const std::string &folder, std::string_view name);
  const std::map<std::string, std::vector<std::string>> &entries(const std::string &folder);

  SourceManager &sources_;
  Diagnostics &diagnostics_;
  std::vector<std::string> folders_;
  std::deque<ast::Tree> trees_;
  std::vector<const ast::File *> given_;
  std::vector<std::string> paths_;
  std::map<std::string, const ast::File *> parsed_;  // by canonical path
  std::map<std::string, const ast::ClassDefinition *, std::less<>> topLevel_;
  std::map<const ast::ClassDefinition *, std::string> packageFolders_;
  // Lower-case names of a folder's entries, read once.
  std::map<std::string, std::map<std::string, std::vector<std::string>>> listings_;
};

}  // namespace tf::semantics
