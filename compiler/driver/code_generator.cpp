#include "compiler/driver/code_generator.h"
#include "compiler/driver/diagnostics.h"

#include <dlfcn.h>
#include <filesystem>
#include <string>

namespace tf::driver {

namespace {

// Beside the program, or in ../lib when installed. By full path: under the address sanitizer dlopen does not see the program's run path.
void *openCodeGenerator() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const char *place : {".", "../lib"}) {
    const std::filesystem::path file = folder / place / "libtfcodegen.so";
    if (std::filesystem::exists(file, error))
      return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  }
  return dlopen("libtfcodegen.so", RTLD_NOW | RTLD_LOCAL);
}

}  // namespace

CodeGenerator *codeGenerator(Session &session) {
  static CodeGenerator *generator = nullptr;
  if (generator != nullptr)
    return generator;
  void *library = openCodeGenerator();
  void *symbol = library == nullptr ? nullptr : dlsym(library, "tf_make_code_generator");
  if (symbol == nullptr) {
    session.diagnostics.report(diag::NoCodeGenerator, {}, dlerror());
    return nullptr;
  }
  generator = reinterpret_cast<decltype(&tf_make_code_generator)>(symbol)();
  return generator;
}

}  // namespace tf::driver
