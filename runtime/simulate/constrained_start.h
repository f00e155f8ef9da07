// Starts that satisfy the constraints (language reference, start): those with `fixed = false` are moved onto them, nearest to their values.
#pragma once

#include "runtime/integrate/model_evaluation.h"

#include <string>

namespace tf::runtime {

class ConstrainedStart {
public:
  explicit ConstrainedStart(ModelEvaluation &evaluation);

  // Moves the free coordinates and velocities in `state`. Empty, or what is wrong: the constraint that the fixed starts violate.
  std::string solve(double time, double *state);

private:
  void solveCoordinates(double *state);
  void solveVelocities(double *state);
  [[nodiscard]] bool contradict(const std::vector<int> &rows, const std::vector<int> &free) const;
  [[nodiscard]] std::string violation(bool ofVelocities) const;
  // Least change of the free velocities (or of coordinates along them) that makes H x = −residual, into change_.
  void leastChange(const std::vector<double> &residual, const std::vector<int> &free, bool holonomicOnly);

  ModelEvaluation &at_;
  std::vector<int> freeCoordinates_, freeVelocities_;  // numbers of velocities along which they move
  std::vector<double> change_;
};

}  // namespace tf::runtime
