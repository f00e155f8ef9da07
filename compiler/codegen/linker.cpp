#include "compiler/codegen/linker.h"

#include <lld/Common/Driver.h>
#include <llvm/Support/raw_ostream.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <link.h>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <vector>

LLD_HAS_DRIVER(elf)

namespace tf::codegen {

namespace {

// A directory of its own, removed with all that is in it.
class TemporaryDirectory {
public:
  TemporaryDirectory() {
    std::error_code error;
    std::string pattern = (std::filesystem::temp_directory_path(error) / "tfc-XXXXXX").string();
    if (error || mkdtemp(pattern.data()) == nullptr)
      throw std::runtime_error("cannot make a temporary directory '" + pattern + "': " + std::strerror(errno));
    path_ = pattern;
  }
  TemporaryDirectory(const TemporaryDirectory &) = delete;
  TemporaryDirectory &operator=(const TemporaryDirectory &) = delete;
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::string file(const char *name) const { return (path_ / name).string(); }

private:
  std::filesystem::path path_;
};

void writeFile(const std::string &path, const std::string &bytes) {
  std::ofstream file(path, std::ios::binary);
  if (!file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
    throw std::runtime_error("cannot write the temporary file '" + path + "': " + std::strerror(errno));
}

std::string readFile(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file || bytes.empty())
    throw std::runtime_error("cannot read the temporary file '" + path + "'");
  return bytes;
}

// The math library that this process uses; empty if there is none. Named to the linker so that the model asks for it itself, with its
// current symbol versions.
std::string mathLibrary() {
  std::string path;
  dl_iterate_phdr(
      [](dl_phdr_info *info, std::size_t, void *result) {
        const std::string_view name = info->dlpi_name;
        if (name.find("/libm.so.") == std::string_view::npos)
          return 0;
        *static_cast<std::string *>(result) = name;
        return 1;
      },
      &path);
  return path;
}

}  // namespace

std::string linkShared(const std::string &object) {
  static std::mutex mutex;  // lld has global state
  const std::scoped_lock lock(mutex);
  const TemporaryDirectory directory;
  const std::string input = directory.file("model.o");
  const std::string output = directory.file("model.so");
  writeFile(input, object);
  const std::string math = mathLibrary();
  std::vector<const char *> arguments{"ld.lld", "-shared",     "--threads=1", "--build-id=none", "--hash-style=gnu", "-z", "now",
                                      "-z",     "noexecstack", "-o",          output.c_str(),    input.c_str()};
  if (!math.empty())
    arguments.insert(arguments.end(), {"--as-needed", math.c_str()});
  std::string messages;
  llvm::raw_string_ostream stream(messages);
  const std::array drivers{lld::DriverDef{lld::Gnu, &lld::elf::link}};
  const lld::Result result = lld::lldMain(arguments, stream, stream, drivers);
  if (result.retCode != 0 || !result.canRunAgain)
    throw std::runtime_error("linking the model failed: " + messages);
  return readFile(output);
}

}  // namespace tf::codegen
