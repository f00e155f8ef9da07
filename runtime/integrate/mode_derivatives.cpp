// Derivatives of a mode's right-hand side: the Jacobian of implicit methods, and the rates that degenerate contact problems are decided by.
#include "runtime/integrate/all_finite.h"
#include "runtime/integrate/mode_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

bool areZero(const std::vector<double> &values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == 0; });
}

}  // namespace

void ModeDynamics::differenceJacobian(double time, const double *state, double *matrix) {
  const int n = size();
  std::copy_n(state, n, shifted_.begin());
  std::vector<double> point(state, state + n);
  for (int k = 0; k < n - 1; ++k) {
    const double step = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(at_.scales.nominal()[k], std::abs(state[k]));
    point[k] = state[k] + step;
    std::vector<double> plus(n), minus(n);
    const bool up = evaluate(time, point.data(), plus.data());
    point[k] = state[k] - step;
    const bool down = evaluate(time, point.data(), minus.data());
    point[k] = state[k];
    for (int i = 0; i < n; ++i)
      matrix[k * n + i] = up && down ? (plus[i] - minus[i]) / (2 * step) : 0;
  }
}

// d q'/d y_k
void ModeDynamics::kinematicColumn(int k, double *column) const {
  const tf_model &model = at_.model();
  const int velocity = k - model.nq;
  if (velocity >= model.nv)
    return;
  if (model.kinematics == nullptr) {
    if (velocity >= 0)
      column[velocity] = 1;
    return;
  }
  for (int i = 0; i < model.nq; ++i)
    column[i] = velocity < 0 ? at_.kinematicsByCoordinate[i * model.nq + k] : at_.kinematicMatrix[i * model.nv + velocity];
}

// d μ/d x_k of contacts' rows, and of the limits of all rows at fixed forces. Rows across a slip have none.
void ModeDynamics::limitColumn(int k, std::vector<double> &friction, std::vector<double> &limit) const {
  const int nx = at_.columns();
  for (int j = 0; j < problem_.tangentCount; ++j) {
    friction[j] = limit[j] = 0;
    if (problem_.isAcross(j))
      continue;
    if (const int owner = problem_.owner[j]; owner >= 0) {
      friction[j] = at_.frictionByState[rows_.contacts()[owner] * nx + k];
      limit[j] = friction[j] * closedForce_[owner];
    } else {
      limit[j] = at_.boundByState[rows_.tangents()[j] * nx + k];
    }
  }
}

bool ModeDynamics::sharesMove() {
  if (rows_.count() == 0)
    return false;
  complete();
  return forces_.sharesMove();
}

bool ModeDynamics::jacobian(double time, const double *state, double *matrix) {
  const tf_model &model = at_.model();
  const int n = size();
  const int nx = at_.columns();
  std::fill_n(matrix, n * n, 0.0);
  // Second derivatives of the conditions are not part of a compiled model.
  if (!sliding_.empty()) {
    differenceJacobian(time, state, matrix);
    return true;
  }
  complete();
  solveMultipliers();
  at_.dynamicsDerivatives(mask_.data());
  const bool areShared = sharesMove() && forces_.sharesAreSmooth();
  if (areShared)
    shareDerivatives_.evaluate(at_, rows_, mask_.data(), forces_.shareMultipliers());
  at_.kinematicsDerivatives();
  slips_.differentiate(time, state);
  const int normals = rows_.normalCount();
  std::vector<double> forceChange(model.nv), constraintChange(model.nh), biasChange(rows_.count()), limitChange(rows_.tangents().size()),
      column(model.nv), shareChange(rows_.count()), frictionChange(rows_.tangents().size());
  const ShareRates shares = {shareChange.data(), frictionChange.data()};
  for (int k = 0; k < n - 1; ++k) {
    for (int i = 0; i < model.nv; ++i)
      forceChange[i] = -at_.residualByState[i * nx + k];
    for (int i = 0; i < model.nh; ++i)
      constraintChange[i] = at_.constraintByState[i * nx + k];
    for (int i = 0; i < rows_.count(); ++i)
      biasChange[i] = i < normals ? at_.normalByState[rows_.contacts()[i] * nx + k]
                                  : rows_.tangentValue(at_.tangentByState.data() + k, nx, i - normals);
    if (areShared)
      shareDerivatives_.column(at_, rows_, k, shareChange);
    for (int p = 0; p < slips_.count() && k < model.nq + model.nv; ++p) {
      const int across = normals + slips_.row(p) + 1;
      const double turning = slips_.turning(p, k), change = rowForces()[across - 1] * turning;
      for (int i = 0; i < model.nv; ++i)
        forceChange[i] += rows_.jacobian(across)[i] * change;
      if (areShared)
        shareChange[across - 1] += shareDerivatives_.product(rows_, across) * turning;
    }
    limitColumn(k, frictionChange, limitChange);
    double *target = matrix + static_cast<std::ptrdiff_t>(k) * n;
    if (areShared || !areZero(forceChange) || !areZero(constraintChange) || !areZero(biasChange) || !areZero(limitChange)) {
      response(forceChange.data(), constraintChange.data(), biasChange.data(), limitChange.data(), column.data(),
               areShared ? &shares : nullptr);
      std::copy(column.begin(), column.end(), target + model.nq);
    }
    for (int i = 0; i < model.nz; ++i)
      target[model.nq + model.nv + i] = at_.stateRateByState[i * nx + k];
    kinematicColumn(k, target);
  }
  return allFinite(matrix, n * n);
}

void ModeDynamics::turningDerivatives(double *rateByAngle, double *angleByState) {
  const tf_model &model = at_.model();
  const int n = size(), entries = n * slips_.count();
  complete();
  slips_.differentiateByVelocity();
  std::fill_n(rateByAngle, entries, 0.0);
  std::fill_n(angleByState, entries, 0.0);
  std::vector<double> &forceChange = shifted_;
  for (int p = 0; p < slips_.count(); ++p, rateByAngle += n, angleByState += n) {
    const int across = rows_.normalCount() + slips_.row(p) + 1;
    for (int i = 0; i < model.nv; ++i)
      forceChange[i] = rows_.jacobian(across)[i] * rowForces()[across - 1];
    response(forceChange.data(), nullptr, nullptr, nullptr, rateByAngle + model.nq);
    for (int k = model.nq; k < model.nq + model.nv; ++k)
      angleByState[k] = slips_.turning(p, k);
  }
}

void ModeDynamics::accelerationRates(const RowSystem &rows, const double *rate, std::vector<double> &accelerationRate,
                                     std::vector<double> &frictionRate, std::vector<double> &boundRate) {
  const tf_model &model = at_.model();
  const int nx = at_.columns();
  std::vector<std::uint8_t> mask = mask_;
  for (const int contact : rows.contacts())
    mask[contact] = 1;
  completeRows();
  solveMultipliers();
  at_.dynamicsDerivatives(mask.data());
  std::vector<double> direction(rate, rate + model.nq + model.nv + model.nz);
  direction.insert(direction.end(), at_.inputRate.begin(), at_.inputRate.end());
  direction.push_back(1);
  const auto along = [&](const std::vector<double> &matrix, int row) {
    double sum = 0;
    for (int k = 0; k < nx; ++k)
      sum += matrix[row * nx + k] * direction[k];
    return sum;
  };
  std::vector<double> jerk(model.nv);
  for (int i = 0; i < model.nv; ++i)
    jerk[i] = -along(at_.residualByState, i);
  // Friction turns with the slip: ds/dt = (across acceleration) / ‖v_t‖ times the direction across.
  for (int p = 0; p < slips_.count(); ++p) {
    const int across = rows_.normalCount() + slips_.row(p) + 1;
    const double speed = slips_.speed(p);
    if (speed <= 10 * slips_.rounding(p))
      continue;
    const double acceleration =
        rows_.product(across, at_.acceleration.data()) + rows_.tangentValue(at_.tangentBias.data(), 1, slips_.row(p) + 1);
    for (int i = 0; i < model.nv; ++i)
      jerk[i] += rows_.jacobian(across)[i] * rowForces()[across - 1] * acceleration / speed;
  }
  std::vector<double> constraintChange(model.nh);
  for (int i = 0; i < model.nh; ++i)
    constraintChange[i] = along(at_.constraintByState, i);
  at_.mobility.accelerate(jerk.data(), constraintChange.data(), jerk.data());
  const int normals = rows.normalCount();
  std::vector<double> modelRate(model.nt);
  for (int row : rows.tangents())
    modelRate[row] = along(at_.tangentByState, row);
  const auto tangentRate = [&](int j) { return rows.tangentValue(modelRate.data(), 1, j); };
  for (int i = 0; i < rows.count(); ++i)
    accelerationRate[i] =
        rows.product(i, jerk.data()) + (i < normals ? along(at_.normalByState, rows.contacts()[i]) : tangentRate(i - normals));
  const std::vector<int> owner = contactsOfTangents(model);
  for (std::size_t j = 0; j < rows.tangents().size(); ++j) {
    const int row = rows.tangents()[j];
    frictionRate[j] = owner[row] >= 0 ? along(at_.frictionByState, owner[row]) : 0;
    boundRate[j] = owner[row] < 0 ? along(at_.boundByState, row) : 0;
  }
}

}  // namespace tf::runtime
