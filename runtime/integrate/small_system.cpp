#include "runtime/integrate/small_system.h"

#include <cmath>
#include <utility>

namespace tf::runtime {

namespace {

// A pivot that has lost all but rounding errors of its diagonal entry is singular.
constexpr double singular = 1e-14;

// By leading principal minors, quotients of which are the pivots: the divisions do not wait for one another.
[[gnu::always_inline]] inline bool factoriseThree(const double *mass, double *factor, double *inverse) {
  const double a = mass[0], b = mass[3], c = mass[4], d = mass[6], e = mass[7], f = mass[8];
  const double second = a * c - b * b, mixed = a * e - b * d;
  const double third = a * (c * f - e * e) - b * (b * f - e * d) + d * (b * e - c * d);
  if (!(a > 0) || !(second > singular * a * std::abs(c)) || !(third > singular * second * std::abs(f)))
    return false;
  inverse[0] = 1 / a;
  inverse[1] = a / second;
  inverse[2] = second / third;
  factor[3] = b * inverse[0];
  factor[6] = d * inverse[0];
  factor[7] = mixed / second;
  return true;
}

// L (row-major, below the diagonal) and 1/Δ of M = L Δ Lᵀ.
template <int nv> [[gnu::always_inline]] inline bool factorise(const double *mass, double *factor, double *inverse) {
  if constexpr (nv == 3)
    return factoriseThree(mass, factor, inverse);
  double rest[nv][nv];
  for (int i = 0; i < nv; ++i)
    for (int j = 0; j <= i; ++j)
      rest[i][j] = mass[i * nv + j];
  for (int k = 0; k < nv; ++k) {
    if (!(rest[k][k] > singular * std::abs(mass[k * nv + k])))
      return false;
    inverse[k] = 1 / rest[k][k];
    for (int i = k + 1; i < nv; ++i) {
      const double scaled = rest[i][k] * inverse[k];
      for (int j = k + 1; j <= i; ++j)
        rest[i][j] -= scaled * rest[j][k];
      factor[i * nv + k] = scaled;
    }
  }
  return true;
}

bool isDiagonal(const double *mass, int size) {
  for (int i = 1; i < size; ++i)
    for (int j = 0; j < i; ++j)
      if (mass[i * size + j] != 0)
        return false;
  return true;
}

template <int nv> [[gnu::always_inline]] inline double product(const double *row, const double (&x)[nv]) {
  double sum = row[0] * x[0];
  for (int k = 1; k < nv; ++k)
    sum += row[k] * x[k];
  return sum;
}

template <int nv> [[gnu::always_inline]] inline void addSlip(const SmallSystem::SlippingRow &slip, double (&x)[nv]) {
  const double factor = -slip.sign * *slip.limit;
  for (int k = 0; k < nv; ++k)
    x[k] += factor * slip.jacobian[k];
}

// 0 times each of the values is added: the sum is not zero where one of them is infinite or NaN.
template <int nv> [[gnu::always_inline]] inline void copyInto(double *target, const double *values, double &sum) {
  for (int k = 0; k < nv; ++k) {
    target[k] = values[k];
    sum += values[k] * 0;
  }
}

template <int nv> bool copyRates(const double *velocity, const double *acceleration, double *rate) {
  double sum = 0;
  copyInto<nv>(rate, velocity, sum);
  copyInto<nv>(rate + nv, acceleration, sum);
  return sum == 0;
}

// A x = b by elimination with partial pivoting; b is the last column. False: a pivot is zero.
template <int count> [[gnu::always_inline]] inline bool eliminate(double (&a)[count][count + 1], double *x, double &determinant) {
  if constexpr (count == 2) {
    determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    const double inverse = 1 / determinant;
    x[0] = (a[0][2] * a[1][1] - a[0][1] * a[1][2]) * inverse;
    x[1] = (a[0][0] * a[1][2] - a[0][2] * a[1][0]) * inverse;
    return std::abs(determinant) > 0;
  }
  determinant = 1;
  for (int k = 0; k < count; ++k) {
    int best = k;
    for (int i = k + 1; i < count; ++i)
      if (std::abs(a[i][k]) > std::abs(a[best][k]))
        best = i;
    if (best != k) {
      for (int j = k; j <= count; ++j)
        std::swap(a[k][j], a[best][j]);
      determinant = -determinant;
    }
    determinant *= a[k][k];
    if (!(std::abs(a[k][k]) > 0))
      return false;
    for (int i = k + 1; i < count; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (int j = k + 1; j <= count; ++j)
        a[i][j] -= factor * a[k][j];
    }
  }
  for (int k = count - 1; k >= 0; --k) {
    double sum = a[k][count];
    for (int j = k + 1; j < count; ++j)
      sum -= a[k][j] * x[j];
    x[k] = sum / a[k][k];
  }
  return true;
}

}  // namespace

// L and 1/Δ of the mass matrix: those kept, or new ones.
template <int nv> struct SmallSystem::Factor {
  bool good = true;

  Factor(const SmallSystem &system, const ModelEvaluation &at) : factor_(system.factor_), inverse_(system.inverse_) {
    if (system.factorRevision_ == at.parameterRevision()) {
      isDiagonal_ = system.isDiagonal_;
      return;
    }
    good = factorise<nv>(at.massMatrix.data(), own_, ownInverse_);
    factor_ = own_;
    inverse_ = ownInverse_;
  }
  Factor(const Factor &) = delete;
  Factor &operator=(const Factor &) = delete;

  // x ← M⁻¹ x
  [[gnu::always_inline]] void divide(double (&x)[nv]) const {
    if (!isDiagonal_)
      for (int i = 1; i < nv; ++i)
        for (int j = 0; j < i; ++j)
          x[i] -= factor_[i * nv + j] * x[j];
    for (int i = 0; i < nv; ++i)
      x[i] *= inverse_[i];
    if (!isDiagonal_)
      for (int i = nv - 1; i > 0; --i)
        for (int j = 0; j < i; ++j)
          x[j] -= factor_[i * nv + j] * x[i];
  }

private:
  const double *factor_, *inverse_;
  bool isDiagonal_ = false;  // L is the unit matrix
  double own_[nv * nv], ownInverse_[nv];
};

// With B the columns of the unknown forces, friction of slipping contacts folded in, and J the active rows:
//     M a = f + B x,   J a + bias = 0
template <int nv, int count> struct SmallSystem::Equations {
  static bool solve(const SmallSystem &system, const ModelEvaluation &at, double *unknowns, double *acceleration, double &determinant) {
    const Factor<nv> mass(system, at);
    if (!mass.good)
      return false;
    double column[count + 1][nv];  // M⁻¹ B, M⁻¹ f
    for (int c = 0; c < count; ++c) {
      for (int k = 0; k < nv; ++k)
        column[c][k] = system.active_[c].jacobian[k];
      if (system.active_[c].slip.jacobian != nullptr)
        addSlip<nv>(system.active_[c].slip, column[c]);
      mass.divide(column[c]);
    }
    for (int k = 0; k < nv; ++k)
      column[count][k] = at.force[k];
    for (const SlippingRow &slip : system.slipping_)
      addSlip<nv>(slip, column[count]);
    mass.divide(column[count]);
    if constexpr (count > 0) {
      double matrix[count][count + 1];
      for (int r = 0; r < count; ++r) {
        for (int c = 0; c < count; ++c)
          matrix[r][c] = product<nv>(system.active_[r].jacobian, column[c]);
        matrix[r][count] = -(product<nv>(system.active_[r].jacobian, column[count]) + *system.active_[r].bias);
      }
      if (!eliminate<count>(matrix, unknowns, determinant))
        return false;
    }
    for (int k = 0; k < nv; ++k) {
      double sum = column[count][k];
      for (int c = 0; c < count; ++c)
        sum += unknowns[c] * column[c][k];
      acceleration[k] = sum;
    }
    return true;
  }

  static bool correct(const SmallSystem &system, const ModelEvaluation &at, const double *residual, double *change) {
    if constexpr (count > 0) {
      const Factor<nv> mass(system, at);
      if (!mass.good)
        return false;
      double column[count][nv], matrix[count][count + 1], impulse[count];
      for (int c = 0; c < count; ++c) {
        for (int k = 0; k < nv; ++k)
          column[c][k] = system.active_[c].jacobian[k];
        mass.divide(column[c]);
      }
      for (int r = 0; r < count; ++r) {
        for (int c = 0; c < count; ++c)
          matrix[r][c] = product<nv>(system.active_[r].jacobian, column[c]);
        matrix[r][count] = residual[r];
      }
      double determinant = 0;
      if (!eliminate<count>(matrix, impulse, determinant))
        return false;
      for (int k = 0; k < nv; ++k)
        for (int c = 0; c < count; ++c)
          change[k] += impulse[c] * column[c][k];
    }
    return true;
  }
};

template <int nv> void SmallSystem::useSize() {
  static_assert(mostUnknowns == 3);
  static constexpr Solve solves[] = {Equations<nv, 0>::solve, Equations<nv, 1>::solve, Equations<nv, 2>::solve, Equations<nv, 3>::solve};
  static constexpr Correct corrections[] = {Equations<nv, 0>::correct, Equations<nv, 1>::correct, Equations<nv, 2>::correct,
                                            Equations<nv, 3>::correct};
  solve_ = solves[active_.size()];
  giveRates_ = copyRates<nv>;
  correct_ = corrections;
}

std::vector<SmallSystem::ActiveRow> &SmallSystem::clear() {
  slipping_.clear();
  active_.clear();
  return active_;
}

bool SmallSystem::start(const ModelEvaluation &at) {
  static_assert(mostVelocities == 6);
  using UseSize = void (SmallSystem::*)();
  static constexpr UseSize sizes[] = {&SmallSystem::useSize<1>, &SmallSystem::useSize<2>, &SmallSystem::useSize<3>,
                                      &SmallSystem::useSize<4>, &SmallSystem::useSize<5>, &SmallSystem::useSize<6>};
  static constexpr bool (*factorisations[])(const double *, double *, double *) = {factorise<1>, factorise<2>, factorise<3>,
                                                                                   factorise<4>, factorise<5>, factorise<6>};
  const tf_model &model = at.model();
  if (model.nv < 1 || model.nv > mostVelocities || model.nh > 0 || active_.size() > mostUnknowns)
    return false;
  (this->*sizes[model.nv - 1])();
  factorRevision_ = model.mass_is_constant != 0 ? at.parameterRevision() : -1;
  if (factorRevision_ < 0)
    return true;
  isDiagonal_ = isDiagonal(at.massMatrix.data(), model.nv);
  return factorisations[model.nv - 1](at.massMatrix.data(), factor_, inverse_);
}

}  // namespace tf::runtime
