// Impacts that accumulate are slow in the end: what ∂gap/∂θ is wrong by moves their times by as much over the gap's rate. A hop that has
// left the ground at δt⁻ begins with ∂gap/∂θ = −c⁺ δt⁻ exactly, c the gap's rate, and what it gains since then is the integral of ∂c/∂θ,
// whose error is a part of the short hop. Where another event at δt changes c, the gap's derivative jumps by (c⁻ − c⁺) δt.
#include "runtime/simulate/sensitivities.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Of the gap's scale: of higher hops the trapezoidal rule is the worse one.
constexpr double low = 1e-10;
// Of the rate's scale: faster hops rise higher.
constexpr double slow = 1e-4;

}  // namespace

// ∂c/∂θ at a point between events.
bool Sensitivities::differentiateRate(double time, const double *state, int contact, Eigen::VectorXd &change) {
  ModelEvaluation &at = dynamics_.model();
  const auto rate = [&at, contact](double where, double *point, double *values) {
    at.setPoint(where, point);
    at.switchingOf(contact);
    *values = at.gapRate[contact];
    return true;
  };
  for (int column = 0; column < columnCount(); ++column)
    if (!differentiate(rate, time, state, column, 1, &change[column]))
      return false;
  return change.allFinite();
}

// The model stands at a time of the last step, and knows the contact's gap there.
void Sensitivities::standInside(SmoothIntegrator &integrator, double time, int contact) {
  hopState_.resize(state_.size());
  integrator.interpolate(time, hopState_.data());
  dynamics_.model().setPoint(time, hopState_.data());
  dynamics_.model().switchingOf(contact);
}

// Between events the hop goes on as the last step has left it.
void Sensitivities::followHopsFrom(SmoothIntegrator &integrator, double time) {
  const ModelEvaluation &at = dynamics_.model();
  const bool isClear = eventsSinceStep_ == 1;
  for (std::size_t i = 0; i < hops_.size() && eventsSinceStep_ > 0; ++i) {
    Hop &hop = hops_[i];
    const bool isOpen = dynamics_.mode().closed[i] == 0;
    if ((hop.begins || hop.isFollowed) && isOpen && isClear) {
      const int contact = static_cast<int>(i);
      standInside(integrator, time, contact);
      const double rate = at.gapRate[contact], fastest = slow * at.scales.gapRate(contact, hopState_.data() + at.model().nq);
      hop.isFollowed = !hop.begins || (rate > 0 && rate <= fastest);
      hop.change = hop.begins ? Eigen::VectorXd(-rate * lastEventTime_) : hop.change + (hop.rate - rate) * lastEventTime_;
      hop.rate = rate;
      hop.isFollowed = hop.isFollowed && differentiateRate(time, hopState_.data(), contact, hop.rateChange);
    } else {
      hop.isFollowed = false;
    }
    hop.begins = false;
  }
  eventsSinceStep_ = 0;
}

void Sensitivities::followHopsTo(SmoothIntegrator &integrator, double time, double length) {
  const ModelEvaluation &at = dynamics_.model();
  for (std::size_t i = 0; i < hops_.size(); ++i) {
    Hop &hop = hops_[i];
    if (!hop.isFollowed)
      continue;
    const int contact = static_cast<int>(i);
    standInside(integrator, time, contact);
    // A step may end on the ground, and be long inside.
    const double height = std::max(at.gap[contact], 0.25 * length * (std::abs(hop.rate) + std::abs(at.gapRate[contact])));
    hop.isFollowed = height <= low * at.scales.gap(contact, hopState_.data());
    hop.rate = at.gapRate[contact];
    hop.change += 0.5 * length * hop.rateChange;
    hop.isFollowed = hop.isFollowed && differentiateRate(time, hopState_.data(), contact, hop.rateChange);
    hop.change += 0.5 * length * hop.rateChange;
  }
}

}  // namespace tf::runtime
