#pragma once

#include <string>

namespace tf::driver {

// Two names of one file, or of one that would be written: also through links and other ways to write its path. False where one is empty.
[[nodiscard]] bool isSameFile(const std::string &first, const std::string &second);

}  // namespace tf::driver
