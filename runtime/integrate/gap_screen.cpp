#include "runtime/integrate/gap_screen.h"

#include "runtime/integrate/byte_flags.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tf::runtime {

namespace {

// A new box costs about as much as reading all gaps so often.
constexpr int costOfBox = 4;
// Coordinates that do not move have boxes of this size, relative to their size, at least their nominal one.
constexpr double smallest = 1e-6;
// A gap that is this small, relative to its scale, may touch.
constexpr double touching = 1e-6;
constexpr double rounding = 1e-9;
// So few tell nothing about how long the motion stays in a box.
constexpr int fewReads = 4;

}  // namespace

GapScreen::GapScreen(const tf_model &model, const ContactScales &scales) : model_(&model), scales_(&scales), awake_(model.nc, 1) {
  if (!isUsed())
    return;
  const std::size_t boxes = static_cast<std::size_t>(model.nq) + 1;
  for (int i = 0; model.variation != nullptr && i < model.nc; ++i)
    dependsOnTime_ = dependsOnTime_ || (model.variation[i] & TF_VARIES_WITH_TIME) != 0;
  speed_.resize(boxes - 1);
  center_.resize(boxes);
  radius_.resize(boxes);
  bound_.resize(model.nc);
  ratio_.resize(model.nc);
  clearance_.resize(model.nc);
  isNear_.assign(model.nc, 1);
  held_.assign(model.nc, 0);
}

void GapScreen::forget() {
  isValid_ = hasSpan_ = isBalanced_ = false;
  span_ = 1;
  reads_ = 0;
  std::fill(speed_.begin(), speed_.end(), 0.0);
}

void GapScreen::hold(const std::uint8_t *contacts) {
  if (!isUsed() || std::equal(held_.begin(), held_.end(), contacts))
    return;
  std::copy_n(contacts, held_.size(), held_.begin());
  merge();
}

void GapScreen::merge() {
  bool changed = false;
  for (std::size_t i = 0; i < awake_.size(); ++i) {
    const std::uint8_t now = isNear_[i] | held_[i];
    changed = changed || now != awake_[i];
    awake_[i] = now;
  }
  revision_ += changed ? 1 : 0;
}

bool GapScreen::covers(double time, const double *q) const {
  const int nq = model_->nq;
  bool inside = isValid_ && !(dependsOnTime_ && !(std::abs(time - center_[nq]) <= radius_[nq]));
  for (int k = 0; k < nq; ++k)
    inside = inside && std::abs(q[k] - center_[k]) <= radius_[k];
  return inside;
}

bool GapScreen::covers(const double *center, const double *radius) const {
  const int count = model_->nq + (dependsOnTime_ ? 1 : 0);
  bool inside = isValid_;
  for (int k = 0; k < count; ++k)
    inside = inside && std::abs(center[k] - center_[k]) + radius[k] <= radius_[k];
  return inside;
}

bool GapScreen::isSelective() const {
  constexpr int few = 8;  // of so many
  int count = 0;
  forEachSet(awake_.data(), model_->nc, [&count](int /*contact*/) { ++count; });
  return few * count <= model_->nc;
}

// Bounds are about proportional to the size of the box. What is not a number is near.
int GapScreen::countNear(double share) const {
  int count = 0;
  for (int i = 0; i < model_->nc; ++i)
    count += clearance_[i] > share * bound_[i] ? 0 : 1;
  return count;
}

// For each motion of a fixed length: boxes, of which there are the fewer the larger they are, and the gaps that are read.
void GapScreen::balance() {
  double least = std::numeric_limits<double>::infinity(), best = 1;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const double cost = near_[k] + costOfBox * static_cast<double>(model_->nc) / (shares[k] * static_cast<double>(reads_));
    if (cost < least) {
      least = cost;
      best = shares[k];
    }
  }
  span_ *= best;
}

void GapScreen::evaluate(const double *const *in, double *gap, const double *least) {
  const int nq = model_->nq;
  for (int k = 0; k < nq; ++k)
    radius_[k] = std::max(span_ * speed_[k], smallest * std::max(scales_->nominal()[k], std::abs(center_[k])));
  radius_[nq] = span_;
  for (int k = 0; least != nullptr && k <= nq; ++k)
    radius_[k] = std::max(radius_[k], least[k]);
  const double *arguments[TF_IN_COUNT];
  std::copy_n(in, TF_IN_COUNT, arguments);
  arguments[TF_IN_Q] = center_.data();
  arguments[TF_IN_TIME] = center_.data() + nq;
  arguments[TF_IN_RADIUS] = radius_.data();
  double *const out[] = {gap, bound_.data()};
  model_->gap_bounds(arguments, out, nullptr);
}

void GapScreen::renew(const double *const *in, const double *rate, double *gap, const double *center, const double *least) {
  constexpr double fading = 0.5;
  const int nq = model_->nq, nc = model_->nc;
  bool moves = false;
  for (int k = 0; k < nq; ++k) {
    center_[k] = center != nullptr ? center[k] : in[TF_IN_Q][k];
    speed_[k] = std::isfinite(rate[k]) ? std::max(std::abs(rate[k]), fading * speed_[k]) : 0;
    moves = moves || speed_[k] > 0;
  }
  center_[nq] = center != nullptr ? center[nq] : *in[TF_IN_TIME];
  if (isBalanced_ && reads_ >= fewReads)
    balance();
  evaluate(in, gap, least);
  // The first time span is a small part of the one in which one contact of eight could close.
  if (!hasSpan_ && moves) {
    for (int i = 0; i < nc; ++i)
      ratio_[i] = gap[i] > 0 && bound_[i] >= 0 ? gap[i] / bound_[i] : 0;
    const auto eighth = ratio_.begin() + nc / 8;
    std::nth_element(ratio_.begin(), eighth, ratio_.end());
    span_ *= std::clamp(*eighth / 16, 1e-6, 1e6);
    hasSpan_ = true;
    evaluate(in, gap, least);
  }
  reads_ = 0;
  isBalanced_ = hasSpan_;
  const double farthest = scales_->farthest(center_.data());
  for (int i = 0; i < nc; ++i) {
    clearance_[i] = gap[i] - (touching * scales_->gap(i, center_.data(), farthest) + rounding * std::abs(gap[i]));
    isNear_[i] = clearance_[i] > bound_[i] ? 0 : 1;
  }
  for (std::size_t k = 0; isBalanced_ && k < shares.size(); ++k)
    near_[k] = countNear(shares[k]);
  isValid_ = true;
  merge();
}

}  // namespace tf::runtime
