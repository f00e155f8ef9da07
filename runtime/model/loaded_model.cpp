#include "runtime/model/loaded_model.h"

#include <fmt/format.h>

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace tf::runtime {

namespace {

#if defined(__x86_64__)
constexpr Elf64_Half ownMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr Elf64_Half ownMachine = EM_AARCH64;
#else
#error "the machine code of shared libraries is known for x86-64 and AArch64 only"
#endif

std::string systemError() { return std::generic_category().message(errno); }

// The bytes of a file, read-only.
class FileBytes {
public:
  static Outcome<FileBytes> map(const std::string &path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
      return Failure{systemError()};
    struct stat status{};
    FileBytes bytes;
    std::string error;
    if (fstat(descriptor, &status) != 0)
      error = systemError();
    else if (!S_ISREG(status.st_mode))
      error = S_ISDIR(status.st_mode) ? "it is a directory" : "it is not a regular file";
    else if (status.st_size > 0) {
      bytes.size_ = static_cast<std::size_t>(status.st_size);
      bytes.data_ = mmap(nullptr, bytes.size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
      if (bytes.data_ == MAP_FAILED)
        error = systemError();
    }
    ::close(descriptor);
    if (!error.empty())
      return Failure{error};
    return bytes;
  }
  FileBytes(FileBytes &&other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  FileBytes &operator=(FileBytes &&) = delete;
  ~FileBytes() {
    if (data_ != nullptr && data_ != MAP_FAILED)
      munmap(data_, size_);
  }
  [[nodiscard]] std::string_view text() const { return {static_cast<const char *>(data_), size_}; }

private:
  FileBytes() = default;

  void *data_ = nullptr;
  std::size_t size_ = 0;
};

// Whether the loader can be asked to map the file: it would crash on parts that are missing.
Outcome<void> checkElf(std::string_view bytes) {
  if (bytes.substr(0, SELFMAG) != std::string_view(ELFMAG, SELFMAG))
    return Failure{"it is not a shared library"};
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header)
    return Failure{"the file is incomplete"};
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_machine != ownMachine)
    return Failure{"it was compiled for another kind of machine"};
  if (header.e_type != ET_DYN)
    return Failure{header.e_type == ET_REL ? "it is an object file, not a shared library" : "it is not a shared library"};
  const auto within = [&](std::uint64_t offset, std::uint64_t size) { return offset <= bytes.size() && size <= bytes.size() - offset; };
  if (header.e_phentsize != sizeof(Elf64_Phdr) || !within(header.e_phoff, std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr)) ||
      !within(header.e_shoff, std::uint64_t{header.e_shnum} * header.e_shentsize))
    return Failure{"the file is incomplete"};
  for (std::size_t i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    std::memcpy(&segment, bytes.data() + header.e_phoff + i * sizeof segment, sizeof segment);
    if (segment.p_type == PT_LOAD && !within(segment.p_offset, segment.p_filesz))
      return Failure{"the file is incomplete"};
  }
  return {};
}

// Looked for in the bytes, so that no code of other libraries is run.
Outcome<void> checkSymbol(std::string_view bytes) {
  const std::string_view symbol = TF_MODEL_SYMBOL;
  if (bytes.find(std::string_view(symbol.data(), symbol.size() + 1)) != std::string_view::npos)  // with the end of the string
    return {};
  const std::string_view anyVersion = symbol.substr(0, symbol.find_last_not_of("0123456789") + 1);
  const std::size_t other = bytes.find(anyVersion);
  const std::size_t digit = other == std::string_view::npos ? other : other + anyVersion.size();
  if (digit < bytes.size() && bytes[digit] >= '0' && bytes[digit] <= '9')
    return Failure{"it was compiled for another version of the interface of compiled models; compile it again"};
  return Failure{"it is a shared library, but not a compiled model"};
}

}  // namespace

void LoadedModel::CloseLibrary::operator()(void *library) const { dlclose(library); }

Outcome<LoadedModel> LoadedModel::open(const std::string &path) {
  const auto failure = [&](const std::string &reason) { return Failure{fmt::format("cannot load '{}': {}", path, reason)}; };
  {
    const auto bytes = FileBytes::map(path);
    if (!bytes)
      return failure(bytes.error());
    for (const auto check : {checkElf, checkSymbol})
      if (const auto checked = check(bytes.value().text()); !checked)
        return failure(checked.error());
  }
  const std::string file = path.find('/') == std::string::npos ? "./" + path : path;
  Library library(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (library == nullptr)
    return failure(dlerror());
  const auto *model = static_cast<const tf_model *>(dlsym(library.get(), TF_MODEL_SYMBOL));
  if (model == nullptr)
    return failure("it is a shared library, but not a compiled model");
  if (const auto checked = checkModel(*model); !checked)
    return failure(checked.error());
  return LoadedModel(std::move(library), model);
}

}  // namespace tf::runtime
