#include "compiler/driver/same_file.h"

#include <filesystem>

namespace tf::driver {

bool isSameFile(const std::string &first, const std::string &second) {
  if (first.empty() || second.empty())
    return false;
  std::error_code failure;
  if (std::filesystem::equivalent(first, second, failure))
    return true;
  const auto place = [&failure](const std::string &path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, failure), failure);
  };
  return place(first) == place(second) && !failure;
}

}  // namespace tf::driver
