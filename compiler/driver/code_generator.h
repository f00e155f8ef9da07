// The code generator, a library of its own that is loaded when code has to be generated.
#pragma once

#include "compiler/codegen/codegen.h"
#include "compiler/driver/session.h"

namespace tf::driver {

// Null if it cannot be loaded (reported). Lives until the process ends.
[[nodiscard]] CodeGenerator *codeGenerator(Session &session);

}  // namespace tf::driver
