// Constants that most models of the tests share.
#pragma once

#include <numbers>

namespace tf::test {

inline constexpr double g = 9.81;  // m/s2
inline constexpr double pi = std::numbers::pi;

}  // namespace tf::test
