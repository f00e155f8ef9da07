// The program's version, from the CMake project.
#pragma once

namespace tf::driver {

inline constexpr const char *kVersion = TFC_VERSION;

}  // namespace tf::driver
