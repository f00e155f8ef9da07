// The motion inside an element as the polynomial through its ends and states that shorter elements from its begin end at: for elements in
// which rates are no measure of the motion. Fast components differ by up to the tolerance from what they follow, and their rates by as
// much times the rate at which they decay.
#pragma once

#include <functional>
#include <vector>

namespace tf::runtime {

class InsideStates {
public:
  // Of `count` places inside, `size` numbers each: a polynomial of degree `count` + 1.
  InsideStates(int size, int count);

  void forget() { status_ = Status::Open; }
  // `solve` has been tried since the element is another one.
  [[nodiscard]] bool isTried() const { return status_ != Status::Open; }
  [[nodiscard]] bool isKnown() const { return status_ == Status::Known; }
  // `solveTo`(theta, state): the state at the part theta of the element, by an element that ends there; false where there is none.
  using SolveTo = std::function<bool(double theta, double *state)>;
  void solve(const SolveTo &solveTo);
  // y at theta, where the states are known.
  void interpolate(double theta, const double *begin, const double *end, double *y) const;

private:
  enum class Status { Open, Known, Unsolvable };

  int size_;
  std::vector<double> places_;  // the ends too
  std::vector<double> states_;
  Status status_ = Status::Open;
};

}  // namespace tf::runtime
