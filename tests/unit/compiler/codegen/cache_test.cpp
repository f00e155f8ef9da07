#include "compiler/codegen/cache.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace tf {
namespace {

namespace fs = std::filesystem;

std::string sha256(std::string_view text) {
  Sha256 digest;
  digest.update(text);
  return digest.finish();
}

// Test vectors of FIPS 180-4 (examples of NIST's Cryptographic Standards and Guidelines).
TEST(Sha256Test, StandardVectors) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256Test, PiecesGiveTheDigestOfTheWhole) {
  for (std::size_t length : {55U, 56U, 63U, 64U, 65U, 119U, 200U}) {
    const std::string text(length, 'x');
    Sha256 pieces;
    for (std::size_t at = 0; at < length; at += 7)
      pieces.update(std::string_view(text).substr(at, 7));
    EXPECT_EQ(pieces.finish(), sha256(text)) << length;
  }
}

TEST(CacheKeyTest, PartsAreDelimited) {
  const auto key = [](std::initializer_list<const char *> parts) {
    CacheKey result;
    for (const char *part : parts)
      result.add(part);
    return result.finish();
  };
  EXPECT_NE(key({"ab", "c"}), key({"a", "bc"}));
  EXPECT_NE(key({"ab", ""}), key({"ab"}));
  EXPECT_EQ(key({"ab", "c"}), key({"ab", "c"}));
}

TEST(IdentityTest, IsTheSameWhenAskedAgain) {
  EXPECT_FALSE(hostIdentity().empty());
  for (int k = 0; k < 100; ++k)
    EXPECT_EQ(hostIdentity(), hostIdentity());
  const std::string path = ::testing::TempDir() + "tf-identity";
  std::ofstream(path) << "one";
  const std::string before = fileIdentity(path);
  EXPECT_EQ(fileIdentity(path), before);
  std::ofstream(path) << "four";
  EXPECT_NE(fileIdentity(path), before);
  fs::remove(path);
  EXPECT_EQ(fileIdentity(path), path);
}

class CacheTest : public ::testing::Test {
protected:
  CacheTest() {
    std::string pattern = ::testing::TempDir() + "tf-cache-XXXXXX";
    directory = mkdtemp(pattern.data());
  }
  ~CacheTest() override {
    fs::permissions(directory, fs::perms::owner_all);
    fs::remove_all(directory);
  }

  static std::string contents(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string directory;
};

TEST_F(CacheTest, FindsWhatWasStored) {
  const CodeCache cache(directory + "/deep/er");
  EXPECT_FALSE(cache.find("k").has_value());
  const auto stored = cache.store("k", "library");
  ASSERT_TRUE(stored.has_value());
  EXPECT_EQ(cache.find("k"), stored);
  EXPECT_TRUE(contents(*stored).starts_with("library"));
  EXPECT_FALSE(cache.find("other").has_value());
}

TEST_F(CacheTest, DamagedEntriesAreNotFoundAndCanBeReplaced) {
  const CodeCache cache(directory);
  const std::string library(1000, 'x');
  const std::string path = cache.store("k", library).value();
  const std::string whole = contents(path);
  for (const std::size_t length : {0U, 10U, 999U, 1000U, 1010U, 1023U}) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, length);
    EXPECT_FALSE(cache.find("k").has_value()) << length;
  }
  for (std::size_t at = 0; at < whole.size(); at += 13) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    std::ofstream(path, std::ios::binary) << damaged;
    EXPECT_FALSE(cache.find("k").has_value()) << at;
  }
  EXPECT_EQ(cache.store("k", library), path);
  EXPECT_TRUE(cache.find("k").has_value());
}

TEST_F(CacheTest, UnwritableOrDisabledIsNoError) {
  EXPECT_FALSE(CodeCache("").store("k", "library").has_value());
  EXPECT_FALSE(CodeCache("").find("k").has_value());
  EXPECT_FALSE(CodeCache("/dev/null/tfc").store("k", "library").has_value());
  EXPECT_FALSE(CodeCache("/proc/tfc").store("k", "library").has_value());
  fs::create_directory(directory + "/k.so");  // where the entry should be
  EXPECT_FALSE(CodeCache(directory).find("k").has_value());
  EXPECT_FALSE(CodeCache(directory).store("k", "library").has_value());
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 1) << "no temporary file is left";
}

TEST_F(CacheTest, EntriesUnusedForLongestMakeRoom) {
  const CodeCache cache(directory, 3000);
  const std::string library(900, 'x');
  const auto age = [&](const char *key, int hours) {
    fs::last_write_time(directory + '/' + key + ".so", fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  for (const char *key : {"a", "b", "c"})
    cache.store(key, library);
  age("a", 30);
  age("b", 20);
  age("c", 10);
  EXPECT_TRUE(cache.find("a").has_value()) << "and is now the one used last";
  EXPECT_TRUE(cache.store("d", library).has_value());
  EXPECT_TRUE(cache.find("a").has_value());
  EXPECT_FALSE(cache.find("b").has_value());
  EXPECT_TRUE(cache.find("c").has_value());
  EXPECT_TRUE(cache.find("d").has_value());
  EXPECT_FALSE(cache.store("large", std::string(4000, 'x')).has_value());
}

TEST_F(CacheTest, EnvironmentNamesTheDirectory) {
  setenv("TFC_CACHE_DIR", directory.c_str(), 1);
  EXPECT_EQ(CodeCache::fromEnvironment().store("k", "library"), directory + "/k.so");
  setenv("TFC_CACHE_DIR", "", 1);
  EXPECT_FALSE(CodeCache::fromEnvironment().store("k", "library").has_value());
  unsetenv("TFC_CACHE_DIR");
  setenv("XDG_CACHE_HOME", directory.c_str(), 1);
  EXPECT_EQ(CodeCache::fromEnvironment().store("k", "library"), directory + "/tfc/k.so");
  unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace tf
