#include "runtime/integrate/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

Projection::Projection(ModelEvaluation &evaluation, const RowSystem &rows, const ContactProblem &problem, std::function<void()> complete)
    : at_(evaluation), rows_(rows), problem_(problem), complete_(std::move(complete)), change_(evaluation.model().nv), motion_(change_),
      constraintChange_(evaluation.model().nh), before_(evaluation.stateSize()) {}

void Projection::resize() {
  corrected_.assign(rows_.count(), 0);
  impulse_.assign(rows_.count(), 0.0);
  residual_ = impulse_;
  factored_.clear();
  chosen_.clear();
}

bool Projection::isNeeded() const { return rows_.count() > 0 || at_.model().nh > 0 || at_.model().nr > 0; }

// target += W Jᵀ x with D x = residual_ on the rows that take part.
void Projection::correct(double *target) {
  if (forces_ != nullptr && forces_->correct(at_, corrected_.data(), residual_.data(), target))
    return;
  if (linked_ != nullptr && linked_->correct(at_, corrected_, residual_.data(), target))
    return;
  complete_();
  correctWithDelassus(target);
}

// Of D on the rows that take part; rows of which less than `dependence` of D_rr is left by the others depend on them.
void Projection::factorise(double dependence) {
  const int size = static_cast<int>(chosen_.size());
  factor_.resize(size);
  for (int j = 0; j < size; ++j)
    for (int i = j; i < size; ++i)
      factor_.entry(i, j) = problem_.delassus(chosen_[i], chosen_[j]);
  factor_.factor(dependence);
}

// motion_, relative to the largest one that a row alone asks for, both in units of the nominal magnitudes: how far bodies move, whatever
// their masses are.
double Projection::amplification() const {
  double moved = 0, asked = 0;
  for (std::size_t k = 0; k < motion_.size(); ++k)
    moved = std::max(moved, std::abs(motion_[k]) / at_.scales.lengths()[k]);
  const int normals = rows_.normalCount();
  for (const int row : chosen_) {
    const double length =
        row < normals ? at_.scales.normalLength(rows_.contacts()[row]) : at_.scales.tangentLength(rows_.tangents()[row - normals]);
    asked = std::max(asked, std::abs(residual_[row]) / length);
  }
  return asked > 0 ? moved / asked : 0;
}

// Motion of the chosen rows' solution, into motion_.
void Projection::solveChosen() {
  for (std::size_t k = 0; k < chosen_.size(); ++k)
    solution_[k] = residual_[chosen_[k]];
  factor_.solve(solution_.data(), solution_.data());
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  for (std::size_t k = 0; k < chosen_.size(); ++k)
    impulse_[chosen_[k]] = solution_[k];
  std::fill(motion_.begin(), motion_.end(), 0.0);
  rows_.accelerate(impulse_.data(), motion_.data());
}

// Where D is singular any solution makes the same motion: residuals are consistent but for rounding, which no motion of redundant rows can
// remove. Rows that nearly depend on others (spheres in a regular packing, with walls) may have residuals that contradict these by more
// than that: to remove them too would take a motion far larger than the residuals.
void Projection::correctWithDelassus(double *target) {
  constexpr double dependence = 1e-11, nearDependence = 1e-6, largestAmplification = 1e3;
  const int rows = rows_.count();
  if (factored_ != corrected_) {
    factored_ = corrected_;
    chosen_.clear();
    // Of equal rows the first one stands for all.
    for (int i = 0; i < rows; ++i)
      if (corrected_[i] &&
          std::none_of(chosen_.begin(), chosen_.end(), [&](int other) { return areEqualColumns(problem_.delassus, i, other); }))
        chosen_.push_back(i);
    factorise(dependence);
    solution_.resize(chosen_.size());
  }
  solveChosen();
  if (amplification() > largestAmplification) {
    factorise(nearDependence);
    factored_.clear();
    solveChosen();
  }
  for (std::size_t k = 0; k < motion_.size(); ++k)
    target[k] += motion_[k];
}

// Change of a row's gap or velocity by what the constraints have changed.
double Projection::changeAlong(int row) const { return at_.model().nh > 0 ? rows_.product(row, change_.data()) : 0; }

// Residuals of gaps and holonomic constraints, these already corrected in change_; the largest one relative to its scale.
double Projection::coordinateResiduals() {
  const tf_model &model = at_.model();
  double worst = 0;
  std::fill(change_.begin(), change_.end(), 0.0);
  if (model.nh > 0) {
    at_.constraintResiduals();
    for (int k = 0; k < model.nk; ++k)
      for (int row = model.constraints[k].row_first; row < model.constraints[k].row_first + model.constraints[k].row_count; ++row) {
        constraintChange_[row] = model.constraints[k].holonomic ? -at_.residual[row] : 0;
        worst = std::max(worst, std::abs(constraintChange_[row]) / at_.scales.residual(row));
      }
    at_.mobility.correct(constraintChange_.data(), change_.data());
  }
  double farthest = 0;
  if (rows_.count() > 0) {
    at_.switching(ModelEvaluation::Gaps);
    farthest = at_.scales.farthest(at_.coordinates());
  }
  for (int i = 0; i < rows_.count(); ++i) {
    const bool isNormal = i < rows_.normalCount();
    corrected_[i] = isNormal;
    residual_[i] = isNormal ? -at_.gap[rows_.contacts()[i]] - changeAlong(i) : 0;
    if (isNormal)
      worst = std::max(worst, std::abs(residual_[i]) / at_.scales.gap(rows_.contacts()[i], at_.coordinates(), farthest));
  }
  return worst;
}

// Newton's method with the rows of the last evaluation: its error after one correction is the product of the correction and the change of
// the rows. True: gap rates are those of the coordinates as they are now.
bool Projection::projectCoordinates(double *state) {
  constexpr int mostCorrections = 5;
  constexpr double rounding = 1e-14;
  // Sums over many bodies are seldom zero: what one rounding makes is left to them.
  const double nothing = linked_ != nullptr ? std::numeric_limits<double>::epsilon() : 0;
  // First of all: a quaternion's length changes gaps, and every correction makes it 1.
  at_.normaliseQuaternions(state);
  double previous = std::numeric_limits<double>::infinity();
  for (int correction = 0; correction < mostCorrections; ++correction) {
    const double worst = coordinateResiduals();
    if (worst <= nothing || worst > 0.5 * previous)
      return true;
    previous = worst;
    correct(change_.data());
    at_.moveCoordinates(state, change_.data());
    if (worst <= rounding)
      return true;
  }
  return false;
}

void Projection::projectVelocities(double *velocities, const std::uint8_t *stopped, const double *slips, bool hasGapRates) {
  const tf_model &model = at_.model();
  std::fill(change_.begin(), change_.end(), 0.0);
  if (model.nh > 0) {
    at_.constraintResiduals();
    for (int row = 0; row < model.nh; ++row)
      constraintChange_[row] = -at_.residualRate[row];
    at_.mobility.correct(constraintChange_.data(), change_.data());
  }
  const int rows = rows_.count(), normals = rows_.normalCount();
  bool anySticks = false;
  for (int i = 0; i < rows; ++i) {
    const int j = i - normals;
    corrected_[i] = i < normals || problem_.slipSign[j] == 0 || stopped[j] != 0;
    anySticks = anySticks || (corrected_[i] != 0 && i >= normals);
  }
  const int parts = (rows > 0 && !hasGapRates ? ModelEvaluation::Gaps : 0) | (anySticks ? ModelEvaluation::Slips : 0);
  if (parts != 0)
    at_.switching(parts);
  for (int i = 0; i < rows; ++i) {
    const int j = i - normals;
    if (corrected_[i] == 0) {
      residual_[i] = 0;
      continue;
    }
    const double rate = i < normals ? at_.gapRate[rows_.contacts()[i]] : rows_.tangentValue(at_.slip.data(), 1, j);
    const double wanted = i < normals || slips == nullptr ? 0 : rows_.tangentValue(slips, 1, j);
    residual_[i] = wanted - rate - changeAlong(i);
  }
  correct(change_.data());
  for (int i = 0; i < model.nv; ++i)
    velocities[i] += change_[i];
}

double Projection::project(double time, double *state, const double *scale, const std::uint8_t *stopped, const double *slips) {
  if (!isNeeded())
    return 0;
  const tf_model &model = at_.model();
  at_.setPoint(time, state);
  factored_.clear();
  std::copy_n(state, model.nq + model.nv, before_.begin());
  const bool hasGapRates = projectCoordinates(state);
  projectVelocities(state + model.nq, stopped, slips, hasGapRates);
  double size = 0;
  for (int k = 0; k < model.nq + model.nv; ++k)
    size = std::max(size, std::abs(state[k] - before_[k]) / scale[k]);
  return size;
}

double Projection::residual(double time, const double *state) {
  const tf_model &model = at_.model();
  const double *velocities = state + model.nq;
  double worst = 0;
  const auto include = [&worst](double value, double scale) {
    const double size = std::abs(value) / scale;
    worst = std::isnan(worst) || size <= worst ? worst : size;
  };
  at_.setPoint(time, state);
  if (rows_.count() > 0)
    at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  for (const int contact : rows_.contacts()) {
    include(at_.gap[contact], at_.scales.gap(contact, state));
    include(at_.gapRate[contact], at_.scales.gapRate(contact, velocities));
  }
  for (std::size_t j = 0; j < rows_.tangents().size(); ++j)
    if (problem_.slipSign[j] == 0)
      include(rows_.tangentValue(at_.slip.data(), 1, static_cast<int>(j)), at_.scales.slip(rows_.tangents()[j], velocities));
  if (model.nh > 0)
    at_.constraintResiduals();
  for (int k = 0; k < model.nk; ++k)
    for (int row = model.constraints[k].row_first; row < model.constraints[k].row_first + model.constraints[k].row_count; ++row) {
      include(model.constraints[k].holonomic ? at_.residual[row] : 0, at_.scales.residual(row));
      include(at_.residualRate[row], at_.scales.residualRate(row, velocities));
    }
  return worst;
}

}  // namespace tf::runtime
