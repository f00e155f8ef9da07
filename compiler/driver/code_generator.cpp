#include "compiler/driver/code_generator.h"
#include "compiler/driver/diagnostics.h"

#include <dlfcn.h>

namespace tf::driver {

CodeGenerator *codeGenerator(Session &session) {
  static CodeGenerator *generator = nullptr;
  if (generator != nullptr)
    return generator;
  // Found by the program's run path: beside it, or in ../lib when installed.
  void *library = dlopen("libtfcodegen.so", RTLD_NOW | RTLD_LOCAL);
  void *symbol = library == nullptr ? nullptr : dlsym(library, "tf_make_code_generator");
  if (symbol == nullptr) {
    session.diagnostics.report(diag::NoCodeGenerator, {}, dlerror());
    return nullptr;
  }
  generator = reinterpret_cast<decltype(&tf_make_code_generator)>(symbol)();
  return generator;
}

}  // namespace tf::driver
