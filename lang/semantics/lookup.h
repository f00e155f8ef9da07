// Name lookup (MLS chapter 5): enclosing scopes, inherited members, imports, encapsulated classes, the leading dot, library files.
#pragma once

#include "lang/semantics/context.h"

namespace tf::semantics {

// What a name stands for: one of both, or nothing.
struct Found {
  Class *type = nullptr;
  Component *component = nullptr;
  Class *where = nullptr;    // the class that has it as a member
  bool isEnclosing = false;  // not in the innermost class

  explicit operator bool() const { return type != nullptr || component != nullptr; }
};

// Whether a name that is nowhere declared is worth a search for a library file of that name.
enum class Files : std::uint8_t { Search, Ignore };

[[nodiscard]] Found lookupSimple(Context &context, Class &scope, std::string_view name, Files files);

// A member of a class, inherited ones and those in a package's files included.
[[nodiscard]] Found lookupMember(Context &context, Class &scope, std::string_view name);

// The root scope alone: `.name`.
[[nodiscard]] Found lookupRoot(Context &context, std::string_view name, Files files);

// The class that a type name stands for. Null if there is none: reported.
[[nodiscard]] Class *lookupClass(Context &context, Class &scope, const ast::Reference &reference);

// A dotted name from the root, as `--model` and `import` have it. Null if there is none: not reported.
[[nodiscard]] Class *lookupQualified(Context &context, std::string_view dottedName);

// Reports imports of a class that lead nowhere.
void checkImports(Context &context, const Class &scope);
// Whether an import that leads nowhere would give the name, which was looked up from `scope` in vain: the import is reported then.
[[nodiscard]] bool reportFailedImport(Context &context, const Class &scope, std::string_view name);

// Names visible from `scope`, for suggestions.
[[nodiscard]] std::vector<std::string> visibleNames(Context &context, Class &scope);
[[nodiscard]] std::vector<std::string> memberNames(Context &context, Class &scope);

// "A.B.c" as written.
[[nodiscard]] std::string dotted(const ast::Reference &reference);

}  // namespace tf::semantics
