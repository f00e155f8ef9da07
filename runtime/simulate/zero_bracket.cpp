#include "runtime/simulate/zero_bracket.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void ZeroBracket::narrow(double time, bool isNegative) {
  (isNegative ? high_ : low_) = time;
  isHighShown_ = isHighShown_ || isNegative;
}

double ZeroBracket::next(double proposed) {
  constexpr double same = 1e-12, farthest = 0.1;  // of the step
  constexpr int mostExtensions = 3;
  if (proposed > low_ && proposed < high_)
    return proposed;
  if (isHighShown_)
    return 0.5 * (low_ + high_);
  if (low_ < high_ - same * (high_ - begin_))
    return high_;
  // The step's own zero may lie a little beyond the interpolant's; or its guard does not fall that far at all.
  if (!std::isfinite(proposed) || extensions_ == mostExtensions)
    return low_;
  ++extensions_;
  return high_ = std::min(proposed, low_ + farthest * (low_ - begin_));
}

}  // namespace tf::runtime
