#include "tests/unit/runtime/derivative_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

namespace tf::runtime::test {

namespace {

// Of differences: small against the lengths of the models, a hundredth and more.
constexpr double usualStep = 2e-4;

using Values = std::vector<double>;

std::size_t length(const tf_model &model, int argument) {
  const int lengths[TF_IN_COUNT] = {1,        model.nq, model.nv, model.nz, model.nu, model.np,     model.ns,
                                    model.nv, model.nc, model.nt, model.nz, model.nh, model.nq + 1, model.nv * TF_DIRECTIONS};
  return static_cast<std::size_t>(lengths[argument]);
}

// Blocks of a function's outputs. An empty mask selects all rows.
using Blocks = std::vector<Values>;

Blocks call(tf_function function, const EvaluationPoint &point, const std::vector<int> &sizes, const std::vector<std::uint8_t> &mask = {},
            double fill = 0) {
  Blocks blocks;
  std::vector<double *> out;
  for (const int size : sizes)
    blocks.emplace_back(static_cast<std::size_t>(size), fill);
  for (Values &block : blocks)
    out.push_back(block.data());
  std::array<const double *, TF_IN_COUNT> in{};
  for (std::size_t k = 0; k < in.size(); ++k)
    in[k] = point.in[k].data();
  // At least as many as any function has: twice the contacts, friction elements, switches, constraints.
  const std::vector<std::uint8_t> all(2 * point.in[TF_IN_NORMAL].size() + point.in[TF_IN_TANGENT].size() + point.in[TF_IN_ALPHA].size() + 3,
                                      1);
  function(in.data(), out.data(), mask.empty() ? all.data() : mask.data());
  return blocks;
}

class Check {
public:
  Check(const tf_model &model, const EvaluationPoint &point, double tolerance) : model_(model), point_(point), tolerance_(tolerance) {}

  std::vector<std::string> run() {
    dynamics();
    switches();
    contacts();
    kinematicsDerivatives();
    constraints();
    masks();
    together();
    return std::move(failures_);
  }

private:
  int nx() const { return model_.nq + model_.nv + model_.nz + model_.nu + 1; }

  std::vector<int> dynamicsSizes() const { return {model_.nv * model_.nv, model_.nv, model_.nz}; }
  std::vector<int> switchingSizes() const { return {model_.nc, model_.nc, model_.nt, model_.ns}; }
  std::vector<int> termSizes() const { return {model_.nc * model_.nv, model_.nc, model_.nt * model_.nv, model_.nt, model_.nc, model_.nt}; }
  std::vector<int> derivativeSizes() const {
    return {model_.nv * nx(), model_.nz * nx(), model_.nc * nx(), model_.nt * nx(), model_.nc * nx(), model_.nt * nx(), model_.nh * nx()};
  }
  std::vector<int> constraintSizes() const { return {model_.nh, model_.nh, model_.nh * model_.nv, model_.nh}; }

  // Seven-point central difference of `values` by one entry of one argument.
  Values difference(const std::function<Values(const EvaluationPoint &)> &values, int argument, std::size_t entry,
                    double h = usualStep) const {
    const auto at = [&](double step) {
      EvaluationPoint moved = point_;
      moved.in[static_cast<std::size_t>(argument)][entry] += step;
      return values(moved);
    };
    static constexpr std::array<double, 3> kWeights = {45, -9, 1};
    Values result;
    for (std::size_t k = 0; k < kWeights.size(); ++k) {
      const double step = static_cast<double>(k + 1) * h;
      const Values above = at(step), below = at(-step);
      result.resize(above.size(), 0.0);
      for (std::size_t i = 0; i < above.size(); ++i)
        result[i] += kWeights[k] * (above[i] - below[i]) / (60 * h);
    }
    return result;
  }

  void compare(const std::string &what, double found, double expected) {
    if (!(std::abs(found - expected) <= tolerance_ * (1 + std::abs(expected))))
      failures_.push_back(what + " = " + std::to_string(found) + ", by differences " + std::to_string(expected));
  }

  // matrix [rows x nx] against differences of `values` [rows] by x = (q, v, z, u, t).
  void compareColumns(const std::string &name, const Values &matrix, const std::function<Values(const EvaluationPoint &)> &values) {
    std::size_t column = 0;
    for (const int argument : {TF_IN_Q, TF_IN_V, TF_IN_Z, TF_IN_U, TF_IN_TIME})
      for (std::size_t entry = 0; entry < length(model_, argument); ++entry, ++column) {
        const Values expected = difference(values, argument, entry);
        for (std::size_t row = 0; row < expected.size(); ++row)
          compare(name + "[" + std::to_string(row) + ", " + std::to_string(column) + "]",
                  matrix[row * static_cast<std::size_t>(nx()) + column], expected[row]);
      }
  }

  // M A - f - Jn^T ln - Jt^T lt.
  Values residual(const EvaluationPoint &point) const {
    const Blocks dynamics = call(model_.dynamics, point, dynamicsSizes()), terms = call(model_.contact_terms, point, termSizes());
    const auto nv = static_cast<std::size_t>(model_.nv);
    Values result(nv);
    for (std::size_t i = 0; i < nv; ++i) {
      result[i] = -dynamics[1][i];
      for (std::size_t j = 0; j < nv; ++j)
        result[i] += dynamics[0][i * nv + j] * point.in[TF_IN_A][j];
      for (std::size_t c = 0; c < static_cast<std::size_t>(model_.nc); ++c)
        result[i] -= terms[0][c * nv + i] * point.in[TF_IN_NORMAL][c];
      for (std::size_t c = 0; c < static_cast<std::size_t>(model_.nt); ++c)
        result[i] -= terms[2][c * nv + i] * point.in[TF_IN_TANGENT][c];
    }
    if (model_.nh == 0)
      return result;
    const Values jacobian = call(model_.constraint_terms, point, constraintSizes())[2];
    for (std::size_t i = 0; i < nv; ++i)
      for (std::size_t c = 0; c < static_cast<std::size_t>(model_.nh); ++c)
        result[i] -= jacobian[c * nv + i] * point.in[TF_IN_MULTIPLIER][c];
    return result;
  }

  // J A + bias of the normal (block 0) or tangential (block 2) rows.
  Values rowAccelerations(const EvaluationPoint &point, std::size_t block) const {
    const Blocks terms = call(model_.contact_terms, point, termSizes());
    const auto nv = static_cast<std::size_t>(model_.nv);
    Values result = terms[block + 1];
    for (std::size_t c = 0; c < result.size(); ++c)
      for (std::size_t j = 0; j < nv; ++j)
        result[c] += terms[block][c * nv + j] * point.in[TF_IN_A][j];
    return result;
  }

  void dynamics() {
    const Blocks derivatives = call(model_.dynamics_derivatives, point_, derivativeSizes());
    compareColumns("d residual/dx", derivatives[0], [this](const EvaluationPoint &p) { return residual(p); });
    compareColumns("dz'/dx", derivatives[1], [this](const EvaluationPoint &p) { return call(model_.dynamics, p, dynamicsSizes())[2]; });
    compareColumns("d gap''/dx", derivatives[2], [this](const EvaluationPoint &p) { return rowAccelerations(p, 0); });
    compareColumns("d slip'/dx", derivatives[3], [this](const EvaluationPoint &p) { return rowAccelerations(p, 2); });
    compareColumns("dmu/dx", derivatives[4], [this](const EvaluationPoint &p) { return call(model_.contact_terms, p, termSizes())[4]; });
    compareColumns("dbound/dx", derivatives[5], [this](const EvaluationPoint &p) { return call(model_.contact_terms, p, termSizes())[5]; });
  }

  void switches() {
    const Blocks gradients = call(model_.switch_gradients, point_, {model_.ns * nx()});
    compareColumns("dc/dx", gradients[0], [this](const EvaluationPoint &p) { return call(model_.switching, p, switchingSizes())[3]; });
    const Blocks steps = call(model_.step_derivatives, point_, {model_.nv * model_.ns, model_.nz * model_.ns});
    for (std::size_t block = 0; block < 2; ++block)
      for (std::size_t j = 0; j < static_cast<std::size_t>(model_.ns); ++j) {
        const Values expected =
            difference([&](const EvaluationPoint &p) { return call(model_.dynamics, p, dynamicsSizes())[block + 1]; }, TF_IN_ALPHA, j);
        for (std::size_t row = 0; row < expected.size(); ++row)
          compare(block == 0 ? "df/dalpha" : "dz'/dalpha", steps[block][row * static_cast<std::size_t>(model_.ns) + j], expected[row]);
      }
  }

  Values kinematics(const EvaluationPoint &point) const {
    return model_.kinematics != nullptr ? call(model_.kinematics, point, {model_.nq})[0] : point.in[TF_IN_V];
  }

  // Rates and biases are total time derivatives along q' = N v, v' = A, t' = 1.
  void contacts() {
    const Blocks rows = call(model_.switching, point_, switchingSizes()), terms = call(model_.contact_terms, point_, termSizes());
    for (std::size_t block = 0; block < 4; block += 2) {  // Jn, Jt
      const std::size_t rateBlock = block == 0 ? 1 : 2;
      for (std::size_t j = 0; j < static_cast<std::size_t>(model_.nv); ++j) {
        const Values expected =
            difference([&](const EvaluationPoint &p) { return call(model_.switching, p, switchingSizes())[rateBlock]; }, TF_IN_V, j);
        for (std::size_t row = 0; row < expected.size(); ++row)
          compare(block == 0 ? "Jn" : "Jt", terms[block][row * static_cast<std::size_t>(model_.nv) + j], expected[row]);
      }
      compareAll(block == 0 ? "gap''" : "slip'", rowAccelerations(point_, block), alongMotion(rateBlock));
    }
    compareAll("gap'", rows[1], alongMotion(0));
  }

  void kinematicsDerivatives() {
    if (model_.kinematics == nullptr)
      return;
    const Blocks found = call(model_.kinematics_derivatives, point_, {model_.nq * model_.nv, model_.nq * model_.nq});
    for (std::size_t block = 0; block < 2; ++block) {
      const auto columns = static_cast<std::size_t>(block == 0 ? model_.nv : model_.nq);
      for (std::size_t j = 0; j < columns; ++j) {
        const Values expected = difference([&](const EvaluationPoint &p) { return kinematics(p); }, block == 0 ? TF_IN_V : TF_IN_Q, j);
        for (std::size_t row = 0; row < expected.size(); ++row)
          compare(block == 0 ? "N" : "d(N v)/dq", found[block][row * columns + j], expected[row]);
      }
    }
  }

  // H A + bias.
  Values constraintAccelerations(const EvaluationPoint &point) const {
    const Blocks terms = call(model_.constraint_terms, point, constraintSizes());
    Values result = terms[3];
    for (std::size_t c = 0; c < result.size(); ++c)
      for (std::size_t j = 0; j < static_cast<std::size_t>(model_.nv); ++j)
        result[c] += terms[2][c * static_cast<std::size_t>(model_.nv) + j] * point.in[TF_IN_A][j];
    return result;
  }

  void constraints() {
    if (model_.nh == 0)
      return;
    const Blocks terms = call(model_.constraint_terms, point_, constraintSizes());
    const auto nv = static_cast<std::size_t>(model_.nv);
    for (std::size_t j = 0; j < nv; ++j) {
      const Values expected =
          difference([&](const EvaluationPoint &p) { return call(model_.constraint_terms, p, constraintSizes())[1]; }, TF_IN_V, j);
      for (std::size_t row = 0; row < expected.size(); ++row)
        compare("H", terms[2][row * nv + j], expected[row]);
    }
    const Values rate = alongMotion(model_.constraint_terms, constraintSizes(), 0);
    for (int i = 0; i < model_.nk; ++i)
      for (int row = model_.constraints[i].row_first; row < model_.constraints[i].row_first + model_.constraints[i].row_count; ++row) {
        const auto k = static_cast<std::size_t>(row);
        compare("constraint rate", terms[1][k], model_.constraints[i].holonomic != 0 ? rate[k] : terms[0][k]);
      }
    compareAll("constraint acceleration", constraintAccelerations(point_), alongMotion(model_.constraint_terms, constraintSizes(), 1));
    const Values derivatives = call(model_.dynamics_derivatives, point_, derivativeSizes())[6];
    compareColumns("d(H A + bias)/dx", derivatives, [this](const EvaluationPoint &p) { return constraintAccelerations(p); });
    for (std::size_t part = 0; part < 2; ++part) {
      const double untouched = 12345;
      const Blocks half =
          call(model_.constraint_terms, point_, constraintSizes(), {static_cast<std::uint8_t>(part == 0), part == 1}, untouched);
      for (std::size_t block = 0; block < 4; ++block)
        for (std::size_t i = 0; i < half[block].size(); ++i)
          compare("masked constraint_terms", half[block][i], block / 2 == part ? terms[block][i] : untouched);
    }
  }

  Values alongMotion(std::size_t block) const { return alongMotion(model_.switching, switchingSizes(), block); }

  // The derivative of one of a function's outputs along q' = N v, v' = A, t' = 1.
  Values alongMotion(tf_function function, const std::vector<int> &sizes, std::size_t block) const {
    const Values qRate = kinematics(point_);
    EvaluationPoint origin = point_;
    Check moving(model_, origin, tolerance_);
    const auto shifted = [&](const EvaluationPoint &p) {  // the entry of TIME that `difference` moves carries q and v along
      EvaluationPoint moved = p;
      const double step = p.in[TF_IN_TIME][0] - origin.in[TF_IN_TIME][0];
      for (std::size_t i = 0; i < qRate.size(); ++i)
        moved.in[TF_IN_Q][i] += step * qRate[i];
      for (std::size_t i = 0; i < moved.in[TF_IN_V].size(); ++i)
        moved.in[TF_IN_V][i] += step * origin.in[TF_IN_A][i];
      return call(function, moved, sizes)[block];
    };
    double speed = 1;  // the coordinates move by about the usual step
    for (const double rate : qRate)
      speed = std::max(speed, std::abs(rate));
    return moving.difference(shifted, TF_IN_TIME, 0, usualStep / speed);
  }

  void compareAll(const std::string &name, const Values &found, const Values &expected) {
    for (std::size_t row = 0; row < found.size(); ++row)
      compare(name + "[" + std::to_string(row) + "]", found[row], expected[row]);
  }

  // Where there is a function for both, it gives what `dynamics` and `contact_terms` give.
  void together() {
    if (model_.contact_dynamics == nullptr)
      return;
    std::vector<int> sizes = dynamicsSizes();
    const std::vector<int> terms = termSizes();
    sizes.insert(sizes.end(), terms.begin(), terms.end());
    const Blocks found = call(model_.contact_dynamics, point_, sizes);
    Blocks expected = call(model_.dynamics, point_, dynamicsSizes());
    const Blocks contacts = call(model_.contact_terms, point_, terms);
    expected.insert(expected.end(), contacts.begin(), contacts.end());
    for (std::size_t block = 0; block < expected.size(); ++block)
      compareAll("contact_dynamics block " + std::to_string(block), found[block], expected[block]);
  }

  // With every second contact or friction element selected, the others without force: the others' rows stay, the selected ones' are the
  // same as without mask.
  void masks() {
    const int elements = model_.nc + model_.nf;
    if (elements == 0)
      return;
    const double untouched = 12345;
    for (std::uint8_t parity = 0; parity < 2; ++parity) {
      std::vector<std::uint8_t> mask;
      for (int i = 0; i < elements; ++i)
        mask.push_back(static_cast<std::uint8_t>(i % 2 == parity ? 1 : 0));
      compareMasked("contact_terms", call(model_.contact_terms, point_, termSizes(), mask, untouched),
                    call(model_.contact_terms, point_, termSizes()), mask, 0, untouched);
      maskedSwitching(mask, parity, untouched);
      EvaluationPoint unloaded = point_;
      const auto unload = [&](int element, std::int32_t first, std::int32_t count) {
        if (element < model_.nc)
          unloaded.in[TF_IN_NORMAL][static_cast<std::size_t>(element)] = 0;
        std::fill_n(unloaded.in[TF_IN_TANGENT].begin() + first, count, 0.0);
      };
      for (int i = 0; i < elements; ++i)
        if (mask[static_cast<std::size_t>(i)] == 0) {
          if (i < model_.nc)
            unload(i, model_.contacts[i].tangent_first, model_.contacts[i].tangent_count);
          else
            unload(i, model_.frictions[i - model_.nc].tangent_first, model_.frictions[i - model_.nc].tangent_count);
        }
      const Blocks masked = call(model_.dynamics_derivatives, unloaded, derivativeSizes(), mask, untouched);
      const Blocks full = call(model_.dynamics_derivatives, unloaded, derivativeSizes());
      compareAll("masked d residual/dx", masked[0], full[0]);
      compareMasked("dynamics_derivatives", {masked.begin() + 2, masked.begin() + 6}, {full.begin() + 2, full.begin() + 6}, mask, nx(),
                    untouched);
    }
  }

  // Slips of the other contacts than gaps.
  void maskedSwitching(const std::vector<std::uint8_t> &elements, std::uint8_t conditions, double untouched) {
    std::vector<std::uint8_t> mask(elements.begin(), elements.begin() + model_.nc);
    for (const std::uint8_t selected : elements)
      mask.push_back(1 - selected);
    mask.push_back(conditions);
    const Blocks masked = call(model_.switching, point_, switchingSizes(), mask, untouched);
    const Blocks full = call(model_.switching, point_, switchingSizes());
    for (std::size_t block = 0; block < masked.size(); ++block)
      for (std::size_t row = 0; row < masked[block].size(); ++row) {
        const bool selected = block < 2    ? mask[row] != 0
                              : block == 2 ? mask[static_cast<std::size_t>(model_.nc + elementOfTangent(static_cast<int>(row)))] != 0
                                           : conditions != 0;
        compare("masked switching block " + std::to_string(block) + " row " + std::to_string(row), masked[block][row],
                selected ? full[block][row] : untouched);
      }
  }

  // blocks: rows of contacts (even places: 0, 1, 4 of contact_terms; 0, 2 of derivatives) and of tangential rows; width 0: that of
  // contact_terms.
  void compareMasked(const std::string &name, const Blocks &masked, const Blocks &full, const std::vector<std::uint8_t> &mask, int width,
                     double untouched) {
    const bool terms = width == 0;
    const std::vector<bool> normal =
        terms ? std::vector<bool>{true, true, false, false, true, false} : std::vector<bool>{true, false, true, false};
    for (std::size_t block = 0; block < masked.size(); ++block) {
      const int columns = terms ? (block == 0 || block == 2 ? model_.nv : 1) : width;
      for (std::size_t i = 0; i < masked[block].size(); ++i) {
        const int row = static_cast<int>(i) / columns;
        const bool selected = mask[static_cast<std::size_t>(normal[block] ? row : elementOfTangent(row))] != 0;
        compare("masked " + name + " block " + std::to_string(block) + " row " + std::to_string(row), masked[block][i],
                selected ? full[block][i] : untouched);
      }
    }
  }

  int elementOfTangent(int row) const {
    for (int i = 0; i < model_.nc; ++i)
      if (row >= model_.contacts[i].tangent_first && row < model_.contacts[i].tangent_first + model_.contacts[i].tangent_count)
        return i;
    for (int i = 0; i < model_.nf; ++i)
      if (row >= model_.frictions[i].tangent_first && row < model_.frictions[i].tangent_first + model_.frictions[i].tangent_count)
        return model_.nc + i;
    return 0;
  }

  const tf_model &model_;
  const EvaluationPoint &point_;
  double tolerance_;
  std::vector<std::string> failures_;
};

}  // namespace

EvaluationPoint randomPoint(const tf_model &model, std::vector<double> parameters, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> symmetric(-1, 1), unit(0, 1);
  EvaluationPoint point;
  for (int argument = 0; argument < TF_IN_COUNT; ++argument) {
    Values &values = point.in[static_cast<std::size_t>(argument)];
    values.resize(length(model, argument));
    for (double &value : values)
      value = argument == TF_IN_ALPHA ? unit(generator) : symmetric(generator);
  }
  point.in[TF_IN_P] = std::move(parameters);
  return point;
}

std::vector<std::string> checkDerivatives(const tf_model &model, const EvaluationPoint &point, double tolerance) {
  return Check(model, point, tolerance).run();
}

}  // namespace tf::runtime::test
