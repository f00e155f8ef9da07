#include "runtime/simulate/redundancy.h"
#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

std::string listed(const std::vector<std::string> &names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

}  // namespace

void Redundancy::start() {
  reported_.assign(static_cast<std::size_t>(at_.model().nh), false);
  most_ = 0;
}

void Redundancy::forgetChoice() {
  choicePoint_.clear();
  at_.mobility.keepAll();
}

bool Redundancy::choose(const double *q) {
  constexpr double elsewhere = 1e-5;  // of the nominal magnitude of a coordinate
  if (!isExpected())
    return false;
  bool isElsewhere = choicePoint_.empty();
  for (std::size_t k = 0; k < choicePoint_.size() && !isElsewhere; ++k)
    isElsewhere = std::abs(q[k] - choicePoint_[k]) > elsewhere * at_.scales.nominal()[k];
  if (isElsewhere)
    choicePoint_.assign(q, q + at_.model().nq);
  return at_.mobility.chooseIndependent(isElsewhere);
}

const tf_constraint &Redundancy::constraintOf(int row) const {
  const tf_model &model = at_.model();
  return *std::find_if(model.constraints, model.constraints + model.nk,
                       [row](const tf_constraint &constraint) { return row < constraint.row_first + constraint.row_count; });
}

std::string Redundancy::nameOf(int row) const {
  const tf_constraint &constraint = constraintOf(row);
  return constraint.row_count > 1 ? fmt::format("'{}[{}]'", constraint.name, row - constraint.row_first + 1)
                                  : fmt::format("'{}'", constraint.name);
}

std::vector<std::string> Redundancy::newlyRedundant() {
  std::vector<std::string> texts;
  const int count = at_.model().nh - at_.mobility.rank();
  if (count <= most_)
    return texts;
  most_ = count;
  for (const DependentRow &dependent : at_.mobility.dependentRows()) {
    if (reported_[static_cast<std::size_t>(dependent.row)])
      continue;
    reported_[static_cast<std::size_t>(dependent.row)] = true;
    std::vector<std::string> sources;
    sources.reserve(dependent.sources.size());
    for (const int source : dependent.sources)
      sources.push_back(nameOf(source));
    texts.push_back(fmt::format("constraint {} {} {}", nameOf(dependent.row),
                                sources.empty() ? "moves nothing" : "follows from " + listed(sources),
                                sourceOf(constraintOf(dependent.row).location)));
  }
  return texts;
}

std::string Redundancy::contradiction(double tolerance) {
  if (!isPresent())
    return {};
  const tf_model &model = at_.model();
  const double accepted = std::max(1e-6, 10 * tolerance);
  at_.constraintResiduals();
  double worst = 0;
  for (int row = 0; row < model.nh; ++row)
    if (const double size = std::abs(at_.residual[static_cast<std::size_t>(row)]); size > accepted * at_.scales.residual(row))
      worst = std::max(worst, size);
  if (worst == 0)
    return {};
  // A contradiction is shared by its constraints.
  constexpr double share = 0.1;
  std::vector<std::string> names;
  for (int row = 0; row < model.nh; ++row) {
    if (!(std::abs(at_.residual[static_cast<std::size_t>(row)]) > share * worst))
      continue;
    names.push_back(fmt::format("{} {}", nameOf(row), sourceOf(constraintOf(row).location)));
  }
  const bool several = names.size() > 1;
  return fmt::format("constraint{} {} contradict{} what {} from: the largest residual is {:.6g}", several ? "s" : "", listed(names),
                     several ? "" : "s", several ? "they follow" : "it follows", worst);
}

// Where a row holds a share s of what it held, residuals of rounding ε leave the place ε/s undetermined, on which the direction of the
// motion depends by 1/s again.
std::string Redundancy::singularity(double tolerance) const {
  constexpr double harmless = 100;
  const auto weakest = at_.mobility.weakestRow();
  if (!weakest || std::numeric_limits<double>::epsilon() <= harmless * tolerance * weakest->part * weakest->part)
    return {};
  return undecided(tolerance);
}

std::string Redundancy::undecided(double tolerance) const {
  const auto weakest = at_.mobility.weakestRow();
  const int row = weakest ? weakest->row : 0;
  return fmt::format(
      "at a singular position of constraint {} {} tolerance {:.3g} cannot be met: rounding decides how the mechanism goes on", nameOf(row),
      sourceOf(constraintOf(row).location), tolerance);
}

}  // namespace tf::runtime
