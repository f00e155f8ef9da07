// The point of rest as it is predicted after one impact after the other, extrapolated to the point itself.
//
// A prediction is wrong by O(T²), T the time that is left, with an expansion in powers of T: points predicted while T halves again and
// again are extrapolated to T = 0 (Richardson), and the difference of successive extrapolations tells how accurate that is. Where switches
// change to and fro on the way, as with the sign of a velocity, predictions are wrong by O(T), with as regular an expansion.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace tf::runtime {

// Where contacts come to rest.
struct RestPoint {
  double time = 0;
  std::vector<double> state;        // q, v, z, tau, to the tolerance; the contacts' gaps and rates may be off by as much
  std::vector<int> contacts;        // of the model: those that come to rest, ascending
  std::vector<int> sticking;        // tangential rows of closed contacts whose slip is zero there
  std::vector<double> derivatives;  // of (q, v, z) and time by each sensitivity, where they are asked for
  // What has come together on the way: normal impulses [nc] of the impacts, their loss of energy, loss by friction between them.
  std::vector<double> accumulated;
};

struct RestEstimate {
  double remaining = 0;  // T
  RestPoint point;
  std::vector<double> derivatives;  // of (q, v, z), time and T by each sensitivity
  std::vector<double> totals;       // point.accumulated and what there was before
};

class RestSeries {
public:
  // Of states of so many numbers and so many switches.
  RestSeries(int stateSize, int switchCount) : size_(stateSize), changed_(switchCount), alternates_(switchCount) {}

  // Drops the estimates.
  void forget();
  // As well as what switches have done.
  void restart();
  // A switch has changed its side.
  void recordSwitch(int index) { changed_[index] = 1; }

  [[nodiscard]] bool isEmpty() const { return estimates_.empty(); }
  [[nodiscard]] const RestEstimate &last() const { return estimates_.back(); }
  // Switches change on the way.
  [[nodiscard]] bool alternates() const;
  // The one between the two latest estimates.
  [[nodiscard]] bool alternates(int index) const { return alternates_[index] != 0; }
  // An estimate with this T adds something: it is the first one, much nearer to the point than the last one, or of an earlier course.
  [[nodiscard]] bool isWanted(double remaining) const;
  // True: it is one of another point, or of an earlier course of the motion, and those before it are dropped.
  bool add(RestEstimate estimate);

  // True if the best extrapolation of the latest estimates (of two or more) agrees with the one of one estimate fewer, and with that of the
  // last time, to `tolerance`, relative to max(scale, |y|) [n] and of the time to `timeScale`.
  bool extrapolate(double tolerance, const double *scale, double timeScale);
  // The point, once extrapolate has found it.
  [[nodiscard]] const RestPoint &point() const { return point_; }
  // Gives it its derivatives by so many parameters. True: they are as well known as differences allow, nearly the same with one estimate
  // fewer.
  bool derivativesAgree(double tolerance, int columns);

private:
  [[nodiscard]] Eigen::VectorXd weights(const Eigen::VectorXd &x) const;
  [[nodiscard]] Eigen::VectorXd remaining(std::size_t estimates) const;
  [[nodiscard]] const RestEstimate *latest(std::size_t estimates) const { return estimates_.data() + (estimates_.size() - estimates); }
  [[nodiscard]] double difference(const std::vector<double> &a, const std::vector<double> &b, const double *scale, double timeScale) const;
  [[nodiscard]] std::vector<double> extrapolated(std::size_t estimates) const;
  [[nodiscard]] std::vector<double> extrapolatedDerivatives(std::size_t estimates, int columns) const;
  void extrapolateTotals();

  int size_ = 0;
  std::vector<RestEstimate> estimates_;  // the latest last, T falling
  std::size_t extrapolatedFrom_ = 0;     // how many the best extrapolation takes
  RestPoint point_;
  std::vector<double> best_;           // state and time; empty where there is none
  std::vector<std::uint8_t> changed_;  // since the latest estimate
  std::vector<std::uint8_t> alternates_;
};

}  // namespace tf::runtime
