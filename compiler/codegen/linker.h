// Linking of an object file to a shared library inside the process.
#pragma once

#include <string>

namespace tf::codegen {

// Bytes of an object file to bytes of a shared library that needs the system's libm. Throws std::runtime_error (unwritable directory for
// temporary files, refusal by the linker). Safe to call from several threads, which take turns.
[[nodiscard]] std::string linkShared(const std::string &object);

}  // namespace tf::codegen
