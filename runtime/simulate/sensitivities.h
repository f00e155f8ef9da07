// Forward sensitivities ∂y(t)/∂θ of a run with respect to starts, parameters and inputs, across switches and impacts.
//
// Within a mode S' = A S + b with the mode's Jacobian A, along the trajectory: transients of S are not those of the state, so that a step
// of the integrator is divided until collocation of order 8 that damps them (dampedGaussNodes) agrees with Gauss's, which does not. An
// event at the zero of a guard h moves with θ: δt = −(h_y S + h_θ) / (dh/dt). What happens there is a map R of the state (frozen phases,
// the identity where only the mode changes), so that (saltation; Müller 1995, Leine and Nijmeijer 2004)
//     S⁺ = R_y (S⁻ + f⁻ δt) + R_t δt + R_θ − f⁺ δt.
// Derivatives of guards, of maps and by parameters are central differences of order 4 of these functions themselves, good to about 1e-11.
#pragma once

#include "runtime/integrate/linear_collocation.h"
#include "runtime/integrate/smooth_integrator.h"
#include "runtime/model/model_instance.h"

#include <Eigen/Dense>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tf::runtime {

enum class EventDerivative : std::uint8_t {
  Exists,
  Touches,  // a guard only touches zero: its zero vanishes nearby
  Parts     // several guards are zero at once, but not nearby: which one comes first decides
};

class Sensitivities {
public:
  // Columns: numbers of variables that are parameters, coordinates, velocities, states (their starts) or inputs (a constant offset).
  Sensitivities(ModeDynamics &dynamics, const ModelInstance &instance, const InputSignals &inputs, std::vector<std::int32_t> columns);

  // S = ∂(starts)/∂θ.
  void start(double time);
  // S over a part of the integrator's last step in the dynamics' mode, which is left at a point inside it. False: it could not be
  // evaluated, and is not known (NaN). Slips of two components that are not faster than `held` of their scale do not turn.
  bool addStep(SmoothIntegrator &integrator, double begin, double end, double held = 0);
  // An event at (time, state) with rate f⁻: at the common zero of `guards` (one at least) of the dynamics' mode. Events
  // at times that do not depend on θ need no such call.
  EventDerivative beginEvent(double time, const double *state, const double *rate, const std::vector<int> &guards);
  // The state is mapped. `map` changes the state at a time in place; false where it cannot. Where a map has a kink, the derivatives on both
  // sides are mapped on by those that follow, until `isOneSided` asks.
  using Map = std::function<bool(double time, double *state)>;
  bool propagate(const Map &map, double time, const double *state);
  // The last `propagate` has changed a derivative of a state by more than rounding.
  [[nodiscard]] bool hasMoved() const { return hasMoved_; }
  // Since it was asked last, the state has been mapped such that its derivatives on both sides differ.
  bool isOneSided();
  // The run goes on with the rate f⁺.
  void endEvent(const double *rate);
  // Back to before endEvent, with the rate f⁺ that it was told: S along the event, whose time moves with θ.
  void reopenEvent(const double *rate);
  // An event elsewhere, where it is known how its state (q, v, z) and time move with θ: columnCount() times (n, 1) numbers.
  void setEvent(const double *derivatives);
  // Derivative of values (count of them) at (time, state): `values` is evaluated at neighbouring points. Into `derivative` [count].
  bool differentiate(const std::function<bool(double time, double *state, double *values)> &values, double time, const double *state,
                     int column, int count, double *derivative);

  // The last step could not be differentiated because the motion depends on how redundant contacts share their load.
  [[nodiscard]] bool isShareUnknown() const { return isShareUnknown_; }

  // Not after a failure of addStep.
  [[nodiscard]] bool isKnown() const { return matrix_.allFinite(); }

  // What a run between two steps goes on with, as numbers.
  [[nodiscard]] std::size_t numberCount() const;
  void write(double *numbers) const;
  void read(const double *numbers);

  // Number of (q, v, z).
  [[nodiscard]] int size() const { return n_; }
  [[nodiscard]] int columnCount() const { return static_cast<int>(columns_.size()); }
  // The number of the variable that it is by.
  [[nodiscard]] std::int32_t variableOf(int column) const { return columns_[static_cast<std::size_t>(column)].variable; }
  // ∂(q, v, z)/∂θ_column
  [[nodiscard]] const double *column(int column) const { return matrix_.col(column).data(); }

private:
  // How time, state, parameters and inputs change with θ_column.
  struct Column {
    std::int32_t variable = -1;
    std::vector<double> parameters, inputs;
    bool movesModel = false;  // any of the two is not zero
    double shortening = 1;    // of the steps of the last differences of the rate, which have as much more rounding
  };

  void makeColumn(Column &column, double time);
  // Sets parameters and inputs to those at θ + s δθ; s = 0 restores them.
  void shift(const Column &column, double s);
  // d/ds at s = 0 of `function`(s, values), by central differences, or one-sided ones where one side cannot be evaluated.
  template <class Function> bool difference(const Function &function, double scale, int count, double *derivative);
  // The same of a function without jumps and thresholds, which may have another scale than that of its values: of a frequency after many
  // periods, of what is small beside its nominal value. Steps are shortened as far as that pays; by how many times, nothing where it cannot
  // be evaluated. `magnitudes`: of terms that the values are sums of, and have the rounding errors of, where these are larger than the
  // values.
  template <class Function>
  std::optional<double> differenceOfSmooth(const Function &function, double scale, const double *magnitudes, int count, double *derivative);
  // What a difference is wrong by, relative to how much the values change: at least about that. 1: nothing is known.
  struct DifferenceError {
    double truncation = 0, total = 0;  // total: with rounding
  };
  // The same with the step h.
  template <class Function>
  std::optional<DifferenceError> differenceAt(const Function &function, double h, const double *magnitudes, int count, double *derivative);
  [[nodiscard]] double scaleOf(const Column &column, const double *direction) const;
  // A and b at an end of a piece.
  struct Border {
    Eigen::MatrixXd slope, offset;
    bool isKnown = false;
  };

  bool evaluate(SmoothIntegrator &integrator, double time);
  bool linearise(double time, Eigen::MatrixXd &slope, Eigen::MatrixXd &offset);
  bool sample(SmoothIntegrator &integrator, double begin, double length);
  void sampleBorder(SmoothIntegrator &integrator, double time, Border &border);
  void allowErrors(const IntegratorSettings &settings, double length);
  [[nodiscard]] double pieceError() const;
  [[nodiscard]] double jumpError(double length);
  double judgeJump(const IntegratorSettings &settings, double length, double jump);
  [[nodiscard]] static double nextPiece(double length, double error, double jump);
  [[nodiscard]] Eigen::VectorXd rounding(double length);
  bool addPieces(SmoothIntegrator &integrator, double begin, double end);
  bool holdRows(SmoothIntegrator &integrator, double time);
  auto displacement(const Map &map);
  // Changes that are not larger than `rounding`, relative to what changes, are none.
  bool mapColumns(const Map &map, double time, const double *state, double rounding = 0);
  bool mapBothSides(const Map &map, double time, const double *state);
  bool findKink(const Map &map, double time, const double *state);
  template <class Function> bool kink(const Function &function, double scale, double *jump);
  // The values at s along a column's direction, from (time, state).
  template <class Function> auto along(const Function &values, double time, const double *state, int column);
  [[nodiscard]] double alongScale(int column) const;
  bool differentiateGuard(double time, const double *state, const double *rate, int guard, double &slope, Eigen::VectorXd &change);
  bool differentiateGap(double time, const double *state, int contact, double &slope, Eigen::VectorXd &change);
  bool eventTimes(double time, const double *state, const double *rate, int guard, Eigen::VectorXd &times);
  bool inhomogeneity(double time, const double *state, const Eigen::MatrixXd &slope, Eigen::Ref<Eigen::MatrixXd> b);
  [[nodiscard]] bool movesState() const { return slips_.size() > 0 || dynamics_.hasRedundantRows(); }
  bool differenceRate(Column &column, double time, const double *state, Eigen::Ref<Eigen::VectorXd> b);
  void fixSlips(double time, const double *state);
  // sensitivities_of_hops.cpp
  bool differentiateRate(double time, const double *state, int contact, Eigen::VectorXd &change);
  void standInside(SmoothIntegrator &integrator, double time, int contact);
  void followHopsFrom(SmoothIntegrator &integrator, double time);
  void followHopsTo(SmoothIntegrator &integrator, double time, double length);

  // A contact's hop so low that the derivative of its gap, a difference of positions, would be rounding: the integral of that of its rate
  // since it left the ground.
  struct Hop {
    bool begins = false, isFollowed = false;
    double rate = 0;                     // of the gap, where the last step has ended
    Eigen::VectorXd change, rateChange;  // ∂gap/∂θ there, and of the rate
  };

  ModeDynamics &dynamics_;
  const ModelInstance &instance_;
  const InputSignals &inputs_;
  int n_;                      // of (q, v, z)
  Eigen::VectorXd rateTerms_;  // sizes of what the rate is the sum of where it was linearised: what contacts hold is a difference of forces
  std::vector<Column> columns_;
  std::vector<double> parameters_, shifted_;  // at θ; at the point that is evaluated
  Eigen::MatrixXd matrix_;                    // n × columns
  Eigen::MatrixXd jump_;                      // n × columns: derivative for growing θ less that for falling θ
  Eigen::VectorXd eventTime_;                 // δt of each column
  Eigen::VectorXd lastEventTime_;             // of the event that ended last
  std::vector<Hop> hops_;                     // of each contact
  std::vector<double> hopState_;
  std::vector<int> landings_;  // contacts of the event that has begun
  int eventsSinceStep_ = 0;    // that have ended
  std::vector<double> state_, rate_, samples_, finer_;
  double held_ = 0;                 // of addStep
  std::vector<double> refinement_;  // of each column's differences of a map
  LinearCollocation gauss_, damped_;
  Eigen::MatrixXd largest_, seen_;  // n × columns: |S| up to now; with that of the piece
  bool isShareUnknown_ = false, hasMoved_ = false;
  double piece_ = 0;      // length of the next one that its error suggests; 0: none
  double roundings_ = 1;  // errors of the rate's differences, to those that sums of its terms have
  int jumps_ = 0;         // pieces that have been divided for one, without several in a row between them that have not
  // workspaces of addStep: A and b at the nodes and the ends, the Jacobian with τ, S at the end by either method and what it may be wrong
  // by, S' at the ends and by extrapolation, and the largest
  std::vector<Eigen::MatrixXd> slopes_, offsets_;
  Border begin_, end_;
  Eigen::MatrixXd jacobian_, undamped_, next_, allowed_, visible_, rateAt_, extrapolated_, largestRate_;
  std::vector<double> still_, point_;
  // of slips of two components: their values, by velocities, and the velocities that make up for a change of them
  Eigen::VectorXd slips_, slipChange_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> slipByVelocity_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> velocityBySlip_;
  std::vector<double> rateAndState_;
  const double *scale_ = nullptr;  // of the integrator's states
};

}  // namespace tf::runtime
