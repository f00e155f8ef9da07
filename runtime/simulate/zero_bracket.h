// Where the zero of a guard lies that steps are shortened to, as far as these have shown it.
#pragma once

namespace tf::runtime {

class ZeroBracket {
public:
  // The guard is positive at `begin`, the begin of the step, and an interpolant has it negative at `high`: the step itself may not.
  ZeroBracket(double begin, double high) : begin_(begin), low_(begin), high_(high) {}

  // A step that ends at `time` has left the guard there, ≥ 0 or negative.
  void narrow(double time, bool isNegative);
  // Where the next step should end: at `proposed` if that is inside; infinity: there is no proposal. The low end: the zero is not to be had
  // nearer than that.
  double next(double proposed);

private:
  double begin_, low_, high_;
  bool isHighShown_ = false;  // by a step
  int extensions_ = 0;        // beyond the end that the interpolant gave
};

}  // namespace tf::runtime
