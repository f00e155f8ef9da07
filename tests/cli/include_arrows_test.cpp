// The arrows of the architecture over the #includes: a folder includes itself and the folders that stand under it, never the other way.
#include "tests/support/process.h"

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

namespace tf::test {
namespace {

namespace fs = std::filesystem;

using Folders = std::set<std::string>;

// Direct and indirect dependencies. The compiler knows the runtime by its binary interface alone, the program by libtf's, and by the
// classes that name variables and write files.
const std::map<std::string, Folders> kMayInclude = {
    {"lang/base", {}},
    {"lang/syntax", {"lang/base"}},
    {"lang/semantics", {"lang/base", "lang/syntax"}},
    {"compiler/ir", {"lang/base"}},
    {"compiler/equations", {"lang/base", "lang/semantics", "compiler/ir"}},
    {"compiler/mechanics", {"lang/base", "lang/semantics", "compiler/ir", "compiler/equations", "runtime/abi"}},
    {"compiler/filippov", {"lang/base", "lang/semantics", "compiler/ir", "compiler/mechanics", "runtime/abi"}},
    {"compiler/codegen", {"lang/base", "compiler/ir", "compiler/mechanics", "runtime/abi"}},
    {"compiler/driver",
     {"lang/base", "lang/syntax", "lang/semantics", "compiler/ir", "compiler/mechanics", "compiler/filippov", "compiler/codegen",
      "runtime/abi", "runtime", "runtime/model", "runtime/results"}},
    {"runtime/abi", {}},
    {"runtime", {"runtime/abi", "runtime/model", "runtime/simulate"}},
    {"runtime/profile", {"runtime"}},
    {"runtime/model", {"runtime/abi"}},
    {"runtime/contact", {"runtime/abi"}},
    {"runtime/integrate", {"runtime/abi", "runtime/model", "runtime/contact"}},
    {"runtime/results", {"runtime/abi", "runtime/model", "runtime"}},
    {"runtime/simulate", {"runtime/abi", "runtime/model", "runtime/contact", "runtime/integrate", "runtime"}},
};

// "runtime/contact/lcp.h" is of "runtime/contact", "runtime/tf.h" of "runtime"; what lies deeper belongs to the folder of the second level.
std::string folderOf(const std::string &path) {
  const std::size_t first = path.find('/'), second = path.find('/', first + 1);
  return path.substr(0, second == std::string::npos ? first : second);
}

bool isSource(const fs::path &path) { return path.extension() == ".cpp" || path.extension() == ".h" || path.extension() == ".c"; }

TEST(IncludeArrows, PointOneWay) {
  const std::regex include("#include \"((lang|compiler|runtime|tests)/[^\"]+)\"");
  int seen = 0;
  for (const char *top : {"lang", "compiler", "runtime"}) {
    for (const auto &entry : fs::recursive_directory_iterator(fs::path(TF_SOURCE_DIR) / top)) {
      if (!isSource(entry.path()))
        continue;
      const std::string file = fs::relative(entry.path(), TF_SOURCE_DIR).string(), folder = folderOf(file);
      ASSERT_TRUE(kMayInclude.contains(folder)) << folder << " has no place in the architecture";
      const std::string text = readFile(entry.path());
      for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match) {
        const std::string included = folderOf((*match)[1]);
        ++seen;
        EXPECT_TRUE(included == folder || kMayInclude.at(folder).contains(included)) << file << " includes " << (*match)[1];
      }
    }
  }
  EXPECT_GT(seen, 100);
}

TEST(IncludeArrows, OnlyCodeGenerationSeesLlvm) {
  for (const char *top : {"lang", "compiler", "runtime"}) {
    for (const auto &entry : fs::recursive_directory_iterator(fs::path(TF_SOURCE_DIR) / top)) {
      const std::string file = fs::relative(entry.path(), TF_SOURCE_DIR).string();
      if (!isSource(entry.path()) || folderOf(file) == "compiler/codegen")
        continue;
      const std::string text = readFile(entry.path());
      EXPECT_EQ(text.find("#include <llvm"), std::string::npos) << file;
      EXPECT_EQ(text.find("#include \"llvm"), std::string::npos) << file;
    }
  }
}

}  // namespace
}  // namespace tf::test
