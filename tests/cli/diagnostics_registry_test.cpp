// Every registered diagnostic has a code of its own, a page in the reference and a test.
#include "tests/support/process.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

namespace tf::test {
namespace {

namespace fs = std::filesystem;

struct Kind {
  std::string name, code, file;
};

std::vector<Kind> registeredKinds() {
  const std::regex registration(R"re(TF_DIAGNOSTIC\((\w+), "(TF\d{4})")re");
  std::vector<Kind> kinds;
  for (const char *top : {"lang", "compiler", "runtime"}) {
    for (const auto &entry : fs::recursive_directory_iterator(fs::path(TF_SOURCE_DIR) / top)) {
      if (entry.path().extension() != ".def" || !entry.path().stem().string().ends_with("diagnostics"))
        continue;
      const std::string text = readFile(entry.path());
      for (std::sregex_iterator match(text.begin(), text.end(), registration), end; match != end; ++match)
        kinds.push_back({(*match)[1], (*match)[2], fs::relative(entry.path(), TF_SOURCE_DIR).string()});
    }
  }
  return kinds;
}

TEST(DiagnosticsRegistry, FindsTheKindsOfAllPhases) {
  std::map<std::string, int> files;
  for (const Kind &kind : registeredKinds())
    ++files[kind.file];
  EXPECT_GE(files.size(), 4U);
  EXPECT_GT(files["lang/syntax/diagnostics.def"], 10);
  EXPECT_GT(files["compiler/driver/diagnostics.def"], 10);
}

TEST(DiagnosticsRegistry, CodesAreUnique) {
  std::map<std::string, std::string> codes;
  for (const Kind &kind : registeredKinds()) {
    const auto [place, isNew] = codes.emplace(kind.code, kind.name);
    EXPECT_TRUE(isNew) << kind.code << " is of " << place->second << " and " << kind.name;
  }
}

TEST(DiagnosticsRegistry, EveryKindHasAPage) {
  const fs::path folder = fs::path(TF_SOURCE_DIR) / "lang/reference/diagnostics";
  const std::string index = readFile(folder / "README.md");
  for (const Kind &kind : registeredKinds()) {
    const fs::path page = folder / (kind.code + ".md");
    EXPECT_TRUE(fs::exists(page)) << kind.code << " (" << kind.name << " of " << kind.file << ")";
    EXPECT_NE(index.find(kind.code), std::string::npos) << kind.code << " is not in the index";
  }
}

TEST(DiagnosticsRegistry, NoPageWithoutAKind) {
  const std::vector<Kind> kinds = registeredKinds();
  for (const auto &entry : fs::directory_iterator(fs::path(TF_SOURCE_DIR) / "lang/reference/diagnostics")) {
    const std::string code = entry.path().stem().string();
    if (code == "README")
      continue;
    EXPECT_TRUE(std::any_of(kinds.begin(), kinds.end(), [&](const Kind &kind) { return kind.code == code; })) << code;
  }
}

// `::NAME` or `&NAME` as a whole word.
bool isNamed(const std::string &tests, const std::string &name) {
  for (const char *prefix : {"::", "&"}) {
    const std::string word = prefix + name;
    for (std::size_t place = tests.find(word); place != std::string::npos; place = tests.find(word, place + 1)) {
      const std::size_t end = place + word.size();
      if (end == tests.size() || (std::isalnum(static_cast<unsigned char>(tests[end])) == 0 && tests[end] != '_'))
        return true;
    }
  }
  return false;
}

// A kind is tested where a test names its code or, as C++, the kind itself.
TEST(DiagnosticsRegistry, EveryKindIsTested) {
  std::string tests;
  for (const auto &entry : fs::recursive_directory_iterator(fs::path(TF_SOURCE_DIR) / "tests")) {
    const std::string extension = entry.path().extension();
    if (extension == ".cpp" || extension == ".txt" || extension == ".tf" || extension == ".mo")
      tests += readFile(entry.path());
  }
  for (const Kind &kind : registeredKinds())
    EXPECT_TRUE(isNamed(tests, kind.name) || tests.find(kind.code) != std::string::npos)
        << kind.code << " (" << kind.name << " of " << kind.file << ")";
}

}  // namespace
}  // namespace tf::test
