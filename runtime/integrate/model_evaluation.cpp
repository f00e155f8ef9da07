#include "runtime/integrate/model_evaluation.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

std::vector<double> array(int rows, int columns = 1) { return std::vector<double>(static_cast<std::size_t>(rows) * columns); }

}  // namespace

ModelEvaluation::ModelEvaluation(const tf_model &model, const InputSignals &inputs)
    : scales(model), mobility(MassMatrix(model.nv, model.mass_rows, model.mass_columns), model.nh), massMatrix(array(model.nv, model.nv)),
      force(array(model.nv)), stateRate(array(model.nz)), gap(array(model.nc)), gapRate(array(model.nc)), slip(array(model.nt)),
      condition(array(model.ns)), normal(array(model.nc, model.nv)), normalBias(array(model.nc)), tangent(array(model.nt, model.nv)),
      tangentBias(array(model.nt)), friction(array(model.nc)), bound(array(model.nt)), residual(array(model.nh)),
      residualRate(array(model.nh)), constraintJacobian(array(model.nh, model.nv)), constraintBias(array(model.nh)), rate(array(model.nc)),
      restitution(array(model.nc)), forceByStep(array(model.nv, model.ns)), stateRateByStep(array(model.nz, model.ns)),
      input(array(model.nu)), inputRate(array(model.nu)), stepVariable(array(model.ns)), acceleration(array(model.nv)),
      normalForce(array(model.nc)), tangentForce(array(model.nt)), multiplier(array(model.nh)), model_(&model), inputs_(&inputs),
      someMask_(2 * static_cast<std::size_t>(model.nc) + model.nf + 1), oneMask_(someMask_), screen_(model, scales),
      coordinateRate_(array(model.nq)) {
  const int nx = columns();
  zero_ = displaced_ = array(stateSize());
  shares_ = array(model.nh);
  everything_.assign(static_cast<std::size_t>(model.nc) + model.nf, 1);
  conditionGradient = array(model.ns, nx);
  residualByState = array(model.nv, nx);
  stateRateByState = array(model.nz, nx);
  normalByState = array(model.nc, nx);
  tangentByState = array(model.nt, nx);
  frictionByState = array(model.nc, nx);
  boundByState = array(model.nt, nx);
  constraintByState = array(model.nh, nx);
  if (model.kinematics != nullptr) {
    kinematicMatrix = array(model.nq, model.nv);
    kinematicsByCoordinate = array(model.nq, model.nq);
    coordinateChange_ = array(model.nq);
  }
  contactDynamics_ = {massMatrix.data(), force.data(),       stateRate.data(), normal.data(), normalBias.data(),
                      tangent.data(),    tangentBias.data(), friction.data(),  bound.data()};
  in_[TF_IN_TIME] = &time_;
  in_[TF_IN_U] = input.data();
  in_[TF_IN_ALPHA] = stepVariable.data();
  in_[TF_IN_A] = acceleration.data();
  in_[TF_IN_NORMAL] = normalForce.data();
  in_[TF_IN_TANGENT] = tangentForce.data();
  in_[TF_IN_ZDOT] = stateRate.data();
  in_[TF_IN_MULTIPLIER] = multiplier.data();
}

bool ModelEvaluation::setParameters(const double *parameters) {
  in_[TF_IN_P] = parameters;
  screen_.forget();
  ++parameterRevision_;
  contactParameters();
  if (!model_->mass_is_constant || model_->nv == 0)
    return true;
  // The mass depends on parameters only: any point will do.
  in_[TF_IN_Q] = in_[TF_IN_V] = in_[TF_IN_Z] = zero_.data();
  forces();
  return mobility.setMass(massMatrix.data());
}

void ModelEvaluation::setSegment(double segment) {
  segment_ = segment;
  constantInputs_ = inputs_->isConstant(segment);
  evaluateInputs(segment);
}

void ModelEvaluation::evaluateInputs(double time) {
  inputs_->evaluate(time, segment_, input.data(), inputRate.data());
  for (std::size_t k = 0; k < inputShift_.size(); ++k)
    input[k] += inputShift_[k];
}

void ModelEvaluation::shiftInputs(const double *direction, double s) {
  inputShift_.resize(input.size());
  for (std::size_t k = 0; k < inputShift_.size(); ++k)
    inputShift_[k] = s * direction[k];
  setSegment(segment_);
}

void ModelEvaluation::setPoint(double time, const double *state) {
  time_ = time;
  in_[TF_IN_Q] = state;
  in_[TF_IN_V] = state + model_->nq;
  in_[TF_IN_Z] = state + model_->nq + model_->nv;
  if (!constantInputs_)
    evaluateInputs(time);
}

bool ModelEvaluation::dynamics() {
  forces();
  if (!factoriseMass())
    return false;
  if (model_->nh == 0)
    return true;
  constraintRows();
  for (int row = 0; row < model_->nh; ++row)
    shares_[row] = scales.share(row, constraintJacobian.data() + static_cast<std::ptrdiff_t>(row) * model_->nv);
  return mobility.setConstraints(constraintJacobian.data(), shares_.data());
}

bool ModelEvaluation::factoriseMass() {
  completeMass();
  return model_->mass_is_constant != 0 || model_->nv == 0 || mobility.setMass(massMatrix.data());
}

void ModelEvaluation::contactForces(const std::uint8_t *mask, MassSample *sample) {
  if (model_->contact_dynamics == nullptr) {
    forces(sample);
    contactTerms(mask);
    return;
  }
  model_->contact_dynamics(in_, contactDynamics_.data(), mask);
}

void ModelEvaluation::forces(MassSample *sample) {
  isSampled_ = sample != nullptr;
  if (!isSampled_) {
    double *const out[] = {massMatrix.data(), force.data(), stateRate.data()};
    model_->dynamics(in_, out, nullptr);
    return;
  }
  constexpr std::uint8_t given = 1;
  double *const out[] = {massMatrix.data(), force.data(), stateRate.data(), sample->products()};
  in_[TF_IN_DIRECTIONS] = sample->directions();
  model_->dynamics(in_, out, &given);
  sample->read();
  sampledTime_ = time_;
  sampledState_.assign(in_[TF_IN_Q], in_[TF_IN_Q] + stateSize());
}

void ModelEvaluation::completeMass() {
  if (!isSampled_)
    return;
  isSampled_ = false;
  const double time = time_, *state = in_[TF_IN_Q];
  setPoint(sampledTime_, sampledState_.data());
  ignoredForce_.resize(force.size());
  ignoredRate_.resize(stateRate.size());
  double *const out[] = {massMatrix.data(), ignoredForce_.data(), ignoredRate_.data()};
  model_->dynamics(in_, out, nullptr);
  setPoint(time, state);
}

void ModelEvaluation::switching(int parts) {
  if (screen_.isUsed() && (parts & (Gaps | Slips)) != 0) {
    if (!screen_.covers(time_, in_[TF_IN_Q]))
      renewScreen();
    screen_.count();
    if (readElsewhere_)
      return switchingOfAll(parts | Gaps);
  }
  AwakeMask &awake = awakeMasks_[parts];
  if (awake.revision != screen_.revision()) {
    awake.mask.resize(someMask_.size());
    selectContacts(parts, screen_.awake(), awake.mask);
    awake.revision = screen_.revision();
  }
  read(awake.mask);
}

void ModelEvaluation::switching(int parts, const std::uint8_t *contacts) {
  selectContacts(parts, contacts, someMask_);
  read(someMask_);
}

void ModelEvaluation::switchingOfAll(int parts) {
  const int nc = model_->nc;
  std::fill_n(someMask_.begin(), nc, static_cast<std::uint8_t>((parts & Gaps) != 0));
  std::fill_n(someMask_.begin() + nc, nc + model_->nf, static_cast<std::uint8_t>((parts & Slips) != 0));
  someMask_.back() = (parts & Conditions) != 0;
  if (screen_.isUsed() && (parts & Gaps) != 0)
    readElsewhere_ = !screen_.covers(time_, in_[TF_IN_Q]);
  read(someMask_);
}

void ModelEvaluation::selectContacts(int parts, const std::uint8_t *contacts, SwitchingMask &mask) const {
  const int nc = model_->nc;
  for (int i = 0; i < nc; ++i) {
    mask[i] = (parts & Gaps) != 0 && contacts[i] != 0;
    mask[nc + i] = (parts & Slips) != 0 && contacts[i] != 0;
  }
  std::fill_n(mask.begin() + 2 * static_cast<std::ptrdiff_t>(nc), model_->nf, static_cast<std::uint8_t>((parts & Slips) != 0));
  mask.back() = (parts & Conditions) != 0;
}

void ModelEvaluation::renewScreen() {
  kinematics(coordinateRate_.data());
  screen_.renew(in_, coordinateRate_.data(), gap.data());
  readElsewhere_ = false;
}

void ModelEvaluation::cover(const double *center, const double *radius, const double *coordinateRate) {
  if (screen_.covers(center, radius))
    return;
  screen_.renew(in_, coordinateRate, gap.data(), center, radius);
  readElsewhere_ = false;
}

void ModelEvaluation::cover(GapScreen &screen, const double *center, const double *radius) {
  if (screen.covers(center, radius) && screen.isSelective())
    return;
  // The box is to be no larger than it is asked for.
  gapAtCenter_.resize(model_->nc);
  std::fill(coordinateRate_.begin(), coordinateRate_.end(), 0.0);
  screen.renew(in_, coordinateRate_.data(), gapAtCenter_.data(), center, radius);
}

void ModelEvaluation::switchingOf(int contact) {
  oneMask_[contact] = 1;
  read(oneMask_);
  oneMask_[contact] = 0;
}

void ModelEvaluation::read(const SwitchingMask &mask) {
  double *const out[] = {gap.data(), gapRate.data(), slip.data(), condition.data()};
  model_->switching(in_, out, mask.data());
}

void ModelEvaluation::contactTerms(const std::uint8_t *mask) {
  double *const out[] = {normal.data(), normalBias.data(), tangent.data(), tangentBias.data(), friction.data(), bound.data()};
  model_->contact_terms(in_, out, mask);
}

GapAcceleration ModelEvaluation::gapAcceleration(int contact, const double *accelerations) const {
  const int nv = model_->nv;
  const double *row = normal.data() + static_cast<std::ptrdiff_t>(contact) * nv;
  GapAcceleration sum = {normalBias[contact], std::abs(normalBias[contact])};
  for (int k = 0; k < nv; ++k) {
    sum.value += row[k] * accelerations[k];
    sum.size += std::abs(row[k] * accelerations[k]);
  }
  return sum;
}

void ModelEvaluation::contactParameters() {
  double *const out[] = {rate.data(), restitution.data()};
  model_->contact_parameters(in_, out, nullptr);
}

// How angles move a gap may vanish at one point.
void ModelEvaluation::measureScales(double time, const double *state) {
  displaced_.assign(state, state + stateSize());
  setPoint(time, displaced_.data());
  moveCoordinates(displaced_.data(), scales.lengths().data());
  scales.start();
  for (const double *point : {static_cast<const double *>(displaced_.data()), state}) {
    const std::vector<double> nearby = rowsNearby(time, point);
    setPoint(time, point);
    contactTerms(everything_.data());
    constraintRows();
    clearRounding(nearby);
    scales.include(normal.data(), tangent.data(), constraintJacobian.data());
  }
  scales.finish();
}

// H where the coordinates are displaced by so little that its rows are the same but for rounding.
std::vector<double> ModelEvaluation::rowsNearby(double time, const double *state) {
  constexpr double little = 1e-9;
  if (model_->nh == 0)
    return {};
  std::vector<double> nearby(state, state + stateSize()), way = scales.lengths();
  for (double &part : way)
    part *= little;
  setPoint(time, nearby.data());
  moveCoordinates(nearby.data(), way.data());
  constraintRows();
  return constraintJacobian;
}

// Rows of H that are others nearby, or far smaller than the largest one, vanish, but for rounding errors.
void ModelEvaluation::clearRounding(const std::vector<double> &nearby) {
  constexpr double others = 0.1, farSmaller = 1e-13;
  double largest = 0;
  for (const double entry : constraintJacobian)
    largest = std::max(largest, std::abs(entry));
  for (int row = 0; row < model_->nh; ++row) {
    double *entries = constraintJacobian.data() + static_cast<std::ptrdiff_t>(row) * model_->nv;
    const double *other = nearby.data() + static_cast<std::ptrdiff_t>(row) * model_->nv;
    double size = 0, difference = 0;
    for (int k = 0; k < model_->nv; ++k) {
      size = std::max({size, std::abs(entries[k]), std::abs(other[k])});
      difference = std::max(difference, std::abs(entries[k] - other[k]));
    }
    if (difference > others * size || size < farSmaller * largest)
      std::fill_n(entries, model_->nv, 0.0);
  }
}

void ModelEvaluation::constraintResiduals() { constraintTerms(true, false); }

void ModelEvaluation::constraintRows() { constraintTerms(false, true); }

void ModelEvaluation::constraintTerms(bool residuals, bool rows) {
  if (model_->nh == 0)
    return;
  const std::uint8_t mask[] = {residuals, rows};
  double *const out[] = {residual.data(), residualRate.data(), constraintJacobian.data(), constraintBias.data()};
  model_->constraint_terms(in_, out, mask);
}

void ModelEvaluation::switchGradients(const std::uint8_t *mask) {
  double *const out[] = {conditionGradient.data()};
  model_->switch_gradients(in_, out, mask);
}

void ModelEvaluation::stepDerivatives() {
  double *const out[] = {forceByStep.data(), stateRateByStep.data()};
  model_->step_derivatives(in_, out, nullptr);
}

void ModelEvaluation::dynamicsDerivatives(const std::uint8_t *mask) {
  double *const out[] = {residualByState.data(), stateRateByState.data(), normalByState.data(),    tangentByState.data(),
                         frictionByState.data(), boundByState.data(),     constraintByState.data()};
  model_->dynamics_derivatives(in_, out, mask);
}

void ModelEvaluation::kinematicsDerivatives() {
  if (model_->kinematics == nullptr)
    return;
  double *const out[] = {kinematicMatrix.data(), kinematicsByCoordinate.data()};
  model_->kinematics_derivatives(in_, out, nullptr);
}

void ModelEvaluation::moveCoordinates(double *state, const double *change) {
  if (model_->kinematics == nullptr) {
    for (int i = 0; i < model_->nq; ++i)
      state[i] += change[i];
    return;
  }
  const double *const velocities = in_[TF_IN_V];
  in_[TF_IN_V] = change;
  kinematics(coordinateChange_.data());
  in_[TF_IN_V] = velocities;
  for (int i = 0; i < model_->nq; ++i)
    state[i] += coordinateChange_[i];
  normaliseQuaternions(state);
}

void ModelEvaluation::normaliseQuaternions(double *state) const {
  for (int r = 0; r < model_->nr; ++r) {
    double *quaternion = state + model_->quaternions[r];
    const double length = std::hypot(std::hypot(quaternion[0], quaternion[1]), std::hypot(quaternion[2], quaternion[3]));
    for (int k = 0; k < 4; ++k)
      quaternion[k] /= length;
  }
}

void ModelEvaluation::evaluateOutputs(double *values) {
  double *const out[] = {values};
  model_->outputs(in_, out, nullptr);
}

void ModelEvaluation::energies(double &kinetic, double &potential, double &power) {
  double *const out[] = {&kinetic, &potential, &power};
  model_->energies(in_, out, nullptr);
}

}  // namespace tf::runtime
