#include "runtime/contact/single_contact_phase.h"

#include "runtime/contact/numbers.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Velocities, impulses and stored quantities of the contact, and the law of its friction.
struct Path {
  double normalMobility, coupling, tangentMobility;  // D_nn, D_nt, D_tt
  double friction;                                   // 0: no tangential row
  double rate;
  double normal, slip;  // c2 and c3
  double normalImpulse = 0, tangentImpulse = 0, duration = 0;
  int pieces = 0;

  // λ_t for λ_n = 1: slip, stick, or the slip that friction cannot hold back.
  [[nodiscard]] double tangentShare() const {
    if (friction == 0)
      return 0;
    if (slip != 0)
      return slip > 0 ? -friction : friction;
    if (std::abs(coupling) <= friction * tangentMobility)
      return -coupling / tangentMobility;
    return coupling > 0 ? -friction : friction;
  }

  // One piece: until the slip stops, or `enough` tells the time (numerical) at which the piece's purpose is reached, given the normal
  // acceleration. True if it was; false if the slip has stopped or the contact is not driven apart (normal acceleration ≤ 0: duration −1).
  template <class Enough> bool advance(const Enough &enough) {
    const double share = tangentShare();
    const double normalAcceleration = rate * (normalMobility + coupling * share);
    double tangentAcceleration = friction > 0 ? rate * (coupling + tangentMobility * share) : 0;
    if (slip == 0 && std::abs(share) < friction)
      tangentAcceleration = 0;
    if (!(normalAcceleration > roundingOfSums * rate * normalMobility)) {
      duration = -1;
      return false;
    }
    const double time = enough(normalAcceleration);
    const double stop = slip * tangentAcceleration < 0 ? -slip / tangentAcceleration : infinity;
    const double step = std::min(time, stop);
    normal += normalAcceleration * step;
    slip = stop <= time * (1 + roundingOfSums) ? 0 : slip + tangentAcceleration * step;
    normalImpulse += rate * step;
    tangentImpulse += rate * share * step;
    duration += step;
    ++pieces;
    return time <= stop;
  }
};

}  // namespace

const FrozenResult *SingleContactPhase::run(const FrozenProblem &problem) {
  if (problem.normalCount != 1 || problem.tangentCount > 1)
    return nullptr;
  const bool rubs = problem.tangentCount == 1 && problem.friction[0] > 0;
  const double normalScale = std::sqrt(problem.delassus(0, 0));
  Path path{.normalMobility = problem.delassus(0, 0),
            .coupling = rubs ? problem.delassus(0, 1) : 0,
            .tangentMobility = rubs ? problem.delassus(1, 1) : 0,
            .friction = rubs ? problem.friction[0] : 0,
            .rate = problem.rate[0],
            .normal = problem.normalVelocity[0],
            .slip = rubs ? problem.slipVelocity[0] : 0};
  if (rubs && !(path.tangentMobility > 0))
    return nullptr;
  // Velocities that are zero but for rounding are compared in the metric of D.
  const double tangentScale = rubs ? std::sqrt(path.tangentMobility) : 1;
  const double fastest = std::max(std::abs(path.normal) / normalScale, std::abs(path.slip) / tangentScale);
  if (!(path.normal < -roundingOfSums * fastest * normalScale))
    return nullptr;
  if (std::abs(path.slip) <= roundingOfSums * fastest * tangentScale)
    path.slip = 0;

  // Compression; Newton's law goes on to its target with nothing stored.
  const double coefficient = problem.restitution[0];
  const double target = problem.law[0] == ImpactLaw::Newton ? -coefficient * path.normal : 0;
  double storedWork = 0;
  const auto toTarget = [&path, target](double acceleration) { return (target - path.normal) / acceleration; };
  for (bool reached = false; !reached;) {
    const double velocity = path.normal, before = path.duration;
    reached = path.advance(toTarget);
    if (path.duration < 0 || path.pieces > 4)
      return nullptr;
    storedWork -= path.rate * 0.5 * (velocity + path.normal) * (path.duration - before);
  }
  path.normal = target;

  // Restitution: Poisson's law stores ε times the impulse, Stronge's ε² times the work of compression.
  double left = problem.law[0] == ImpactLaw::Poisson   ? coefficient * path.duration
                : problem.law[0] == ImpactLaw::Stronge ? coefficient * coefficient * storedWork / path.rate
                                                       : 0;
  while (left > 0) {
    const double velocity = path.normal, before = path.duration;
    const bool done = path.advance([&](double acceleration) {
      return problem.law[0] == ImpactLaw::Poisson ? left : 2 * left / (velocity + std::sqrt(velocity * velocity + 2 * acceleration * left));
    });
    if (path.duration < 0 || path.pieces > 8)
      return nullptr;
    const double step = path.duration - before;
    left = done ? 0 : left - (problem.law[0] == ImpactLaw::Poisson ? step : 0.5 * (velocity + path.normal) * step);
  }

  result_.status = FrozenStatus::Finished;
  result_.duration = path.duration;
  result_.impulse.assign(problem.count(), 0.0);
  result_.velocity.assign(problem.normalVelocity.begin(), problem.normalVelocity.end());
  result_.velocity.insert(result_.velocity.end(), problem.slipVelocity.begin(), problem.slipVelocity.end());
  result_.impulse[0] = path.normalImpulse;
  result_.velocity[0] = path.normal;
  if (rubs) {
    result_.impulse[1] = path.tangentImpulse;
    result_.velocity[1] = path.slip;
  }
  result_.rows.clear();
  result_.breakpointCount = path.pieces;
  return &result_;
}

}  // namespace tf::runtime
