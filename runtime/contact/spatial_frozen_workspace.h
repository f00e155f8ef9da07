// The parts of SpatialFrozenPhase: the path from breakpoint to breakpoint (spatial_frozen_phase.cpp), its curved pieces
// (spatial_frozen_curves.cpp), and steps of the implicit Euler method over what is nearly zero or stiff (spatial_frozen_steps.cpp).
#pragma once

#include "runtime/contact/cone_friction.h"
#include "runtime/contact/extrapolation.h"
#include "runtime/contact/frozen_mode.h"
#include "runtime/contact/lu_factor.h"
#include "runtime/contact/numbers.h"
#include "runtime/contact/planar_friction.h"
#include "runtime/contact/spatial_frozen_phase.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace tf::runtime {

struct SpatialFrozenPhase::Workspace {
  static constexpr double feasibility = 1e-9;
  // Accelerations of the iterative solution are zero below this part of the terms that they are sums of.
  static constexpr double solved = 1e-11;
  // Forces smaller than their limit by this part of it are within it, however inexact the solution is.
  static constexpr double withinLimit = 1e-6;
  // Relative to the velocities: below `still` the direction of a slip is that of its reference, and a slip that comes to rest is zero; a
  // piece that leaves its straight continuation by less than `straight` is straight, and one that changes less than `instant` has no
  // length.
  static constexpr double still = 2e-11, straight = 1e-13, accuracy = 1e-13, instant = 1e-20;
  static constexpr int keptBreakpoints = 1000, breakpointLimit = 2000;
  // Of the steps over what is within `still` of zero: how many times as far as that they go, and by how often the next one may be longer.
  static constexpr double stepBand = 32;
  // Before leaps are tried: so many of them.
  static constexpr int mostDoublings = 16, mostEscapes = 3, window = 8;
  static constexpr double crowd = 1e-3, longLeap = 0.1;
  static constexpr int leapColumns = 7;
  static constexpr double leapAccuracy = 1e-12;
  // D_s below this part of what it is the difference of is about to reach zero for a frictional impulse.
  static constexpr double jammed = 1e-3;

  // A quantity that is positive on the piece; the piece ends where it falls to zero.
  struct Watch {
    enum class Kind : std::uint8_t { Normal, Slip, PairSlip, HeldLow, HeldHigh, Stick, StoredImpulse, StoredWork };
    Kind kind = Kind::Normal;
    int index = 0;  // normal or tangential row
    double sign = 1;
    double level = 0;  // of what starts from zero: how far below zero it may fall
  };

  const FrozenProblem *problem = nullptr;
  int n = 0, m = 0;
  PlanarFrictionSolver planar;
  ConeFrictionSolver cone;
  Restitution restitution;
  Extrapolation integrator;
  FrozenResult result;
  std::vector<FrozenBreakpoint> breakpoints;
  FrozenMode mode;
  int kept = 0;
  double tau = 0, scale = 0;                          // scale: largest velocity
  std::vector<double> velocity, impulse;              // c2 (less Newton's target) and c3; total impulses
  std::vector<double> force, acceleration, turnover;  // λ, w = D λ, Σ |D λ|
  std::vector<double> guess;                          // of λ
  std::vector<std::uint8_t> opened;                   // contacts at zero that are not to push
  std::vector<int> leaving;                           // rows whose force has just reached a limit: 1 or −1, by its side
  std::vector<Watch> watches;
  Eigen::VectorXd state, zeroState;  // P − P(begin of the step), ∫ c2 dτ
  std::vector<double> point, pointForce;
  std::vector<int> turning;                              // rows of pairs that slip
  Eigen::MatrixXd forceByTurn, turnByForce, turnByTurn;  // dλ/dv of these rows [(n + m) × r], their D [r × (n + m)], the product
  LuFactor turnFactor;                                   // of I − stepPart · turnByTurn
  Eigen::VectorXd turned;
  double stepPart = 0;
  double integratedLength = 0;  // of the last step; 0: none
  bool isIntegrated = false;    // it was accepted
  double nextLength = 0;
  double roundingSpeed = 0;    // velocities below are within rounding of zero
  double stillSpeed = 0;       // slips below come to rest, or start
  double motionless = solved;  // accelerations are zero below this part of the terms that they are sums of
  double largestChange = 0;    // bound of |D λ|
  int startContact = -1;       // has been given an approach of
  double startSpeed = 0;       // to start a frictional impulse
  int windowSteps = 0, windowBreakpoints = 0, crowding = 0;
  int circling = 0;  // stops of slips that were hardly faster than still ones, and none
  double windowBegin = 0;

  void begin(const FrozenProblem &at, int forced);
  [[nodiscard]] bool pushes(int i) const { return velocity[i] < 0 || restitution.stored(i); }
  [[nodiscard]] bool anyPushes() const;
  // At zero with nothing stored: complementarity decides what the contact does.
  [[nodiscard]] bool restsAt(int i) const { return velocity[i] == 0 && !restitution.stored(i); }
  [[nodiscard]] bool isPair(int j) const { return problem->partner[j] > j; }
  [[nodiscard]] bool isSecond(int j) const { return problem->partner[j] >= 0 && problem->partner[j] < j; }
  [[nodiscard]] double slipSpeed(int j, const std::vector<double> &v) const {
    return isPair(j) ? std::hypot(v[n + j], v[n + j + 1]) : std::abs(v[n + j]);
  }
  // Its velocity tells what the contact does in a step with this band, not complementarity.
  [[nodiscard]] bool isDecided(int i, int forced, double band) const {
    return std::abs(velocity[i]) > band || i == forced || restitution.stored(i);
  }
  bool pose(int forced, double step, double band, ConeFrictionProblem &p);
  bool findForces(int forced, double step, double band);
  bool solveForces(int forced, double step, double band);
  [[nodiscard]] bool stayOpen(double step);
  [[nodiscard]] bool isNormalStill(int i) const;
  [[nodiscard]] bool isSlipStill(int j) const;
  [[nodiscard]] bool anyNearZero() const;
  bool poseStep(int forced, double &step, double band);
  bool stepOver(int forced, double step, double band);
  bool settleNearZero(int forced);
  [[nodiscard]] bool anySlipGrows(const std::vector<double> &before) const;
  void stopNearZero();
  void bringToRest(const std::vector<std::uint8_t> &rests);
  void markRests(const std::vector<double> &from, double step, double band, std::vector<std::uint8_t> &rests) const;
  bool passCrowd(int forced, bool &found);
  void watchCircling(int j);
  bool leap(int forced, double length);
  bool leapOn(int forced, double shortest);
  [[nodiscard]] double bandOfLeap(double length) const;
  void updateAcceleration();
  bool choose(int forced);
  void chooseTangent(int j);
  bool evaluate(int forced);

  double nextBreakpoint(Watch &first) const;
  [[nodiscard]] double departure(double duration) const;
  // In which velocities may change altogether.
  [[nodiscard]] double longPiece() const { return scale / std::max(*std::max_element(turnover.begin(), turnover.end()), 1e-300); }
  void advance(const Watch &event, double duration);
  void listWatches();
  [[nodiscard]] double value(const Watch &watch, double duration) const;
  double responsiveness() const;
  bool rate(const Eigen::VectorXd &y, Eigen::VectorXd &f);
  bool linearise();
  bool factor(double part);
  void solve(Eigen::VectorXd &x);
  bool integrate(double h);
  [[nodiscard]] double slope(const Watch &watch) const;
  [[nodiscard]] double sizeOf(const Watch &watch) const;
  // The last step has missed the accuracy by little, as steps that end at an event may.
  [[nodiscard]] bool nearlyIntegrated() const { return integrator.error() <= 1e3 * accuracy * scale / responsiveness(); }
  // StartsAtLimits: several forces are beyond their limits from the begin of the step on. Failed: the event cannot be located.
  enum class Search : std::uint8_t { Done, StartsAtLimits, Failed };
  Search findEvent(double &h, Watch &event, bool &found);
  double locate(const Watch &watch, double high);
  bool curve(double estimate, bool slipStops, Watch &event, bool &found);
  [[nodiscard]] bool turnsFar() const;
  bool settleStop(const Watch &event, double &h, bool &found);
  void commit(double h, const Watch *event);
  void finishEvent(const Watch &event);
  bool giveUp(bool ends);
  void record(int row, FrozenEvent event);
  [[nodiscard]] FrozenEvent classify(const Watch &event) const;
  void fail(FrozenStatus status);
  void reconcile();
  void exchange(const Watch &event, bool &found);
  bool jams(int forced);
  void follow(int forced);
};

}  // namespace tf::runtime
