// The forces of bodies that are linked in a row: the same as those of the dense equations.
#include "runtime/integrate/contact_system.h"
#include "runtime/integrate/linked_forces.h"
#include "runtime/model/input_signals.h"
#include "tests/unit/runtime/integrate/chain_of_rods.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tf::runtime {
namespace {

using test::Chain;
using test::RowMajor;

constexpr int rods = 40, velocityCount = rods + 2, nodes = rods + 1;

Chain chainAt(const double *q) { return {true, false, std::vector<double>(q + 2, q + velocityCount)}; }

// v is no part of it: bias terms are some numbers.
void dynamics(const double *const *in, double *const *out, const std::uint8_t *) {
  const Chain chain = chainAt(in[TF_IN_Q]);
  const RowMajor M = chain.mass();
  std::copy_n(M.data(), M.size(), out[0]);
  for (int i = 0; i < velocityCount; ++i)
    out[1][i] = -9.81 * M(1, i) + 3 * M(0, i) + 0.001 * std::sin(i);
}

void contactTerms(const double *const *in, double *const *out, const std::uint8_t *) {
  const Chain chain = chainAt(in[TF_IN_Q]);
  for (int node = 0; node < nodes; ++node) {
    const RowMajor J = chain.jacobian(node);
    std::copy_n(J.row(1).data(), velocityCount, out[0] + node * velocityCount);
    std::copy_n(J.row(0).data(), velocityCount, out[2] + node * velocityCount);
    out[1][node] = 0.01 * std::cos(node);
    out[3][node] = 0;
    out[4][node] = in[TF_IN_P][0];
  }
}

void contactParameters(const double *const *, double *const *out, const std::uint8_t *) {
  std::fill_n(out[0], nodes, 1.0);
  std::fill_n(out[1], nodes, 0.0);
}

struct Model {
  std::vector<tf_contact> contacts = std::vector<tf_contact>(nodes);
  tf_model model{};
  Model() {
    for (int node = 0; node < nodes; ++node) {
      contacts[node].name = "node";
      contacts[node].tangent_first = node;
      contacts[node].tangent_count = 1;
      contacts[node].nominal = 1;
    }
    model.nq = model.nv = velocityCount;
    model.np = 1;
    model.nc = model.nt = nodes;
    model.contacts = contacts.data();
    model.dynamics = dynamics;
    model.contact_terms = contactTerms;
    model.contact_parameters = contactParameters;
  }
};

// A chain whose first rods hang above the floor, bent, and whose other ones lie on it.
struct OnFloor {
  explicit OnFloor(int lying, double mu) : inputs(0), at(model.model, inputs), parameters{mu}, state(2 * velocityCount + 1, 0.0) {
    EXPECT_TRUE(at.setParameters(parameters.data()));
    at.setSegment(0);
    for (int i = 0; i < rods - lying; ++i)
      state[2 + i] = -0.9 + 0.02 * i;
    at.setPoint(0, state.data());
    std::vector<int> contacts;
    for (int node = nodes - lying; node < nodes; ++node)
      contacts.push_back(node);
    system.choose(model.model, contacts, contacts);
    mode.resize(lying, lying);
    std::fill(mode.closed.begin(), mode.closed.end(), 1);
    mask.assign(nodes, 1);
  }
  void slip(int contact, int sign) {
    mode.slip[contact] = static_cast<std::int8_t>(sign);
    system.problem.slipSign[contact] = sign;
  }
  bool solveDense() {
    EXPECT_TRUE(at.dynamics());
    at.contactTerms(mask.data());
    system.gather(at);
    system.respond(at);
    expected.resize(velocityCount);
    system.setBias(at, expected.data());
    if (!forces.start(system.problem, mode))
      return false;
    system.rows.accelerate(forces.forces().data(), expected.data());
    return true;
  }
  // In the mode that has begun.
  bool evaluateDense() {
    EXPECT_TRUE(at.dynamics());
    at.contactTerms(mask.data());
    system.gather(at);
    system.respond(at);
    system.setBias(at, expected.data());
    if (!forces.evaluate(system.problem))
      return false;
    system.rows.accelerate(forces.forces().data(), expected.data());
    return true;
  }
  void expectSame() {
    ASSERT_TRUE(solveDense());
    ASSERT_TRUE(linked.choose(at, system.rows, system.problem, mode, forces));
    expectEvaluated();
  }
  // By the linked forces of the mode that has begun, at the point of the dense ones. Shares of forces may differ by more than
  // accelerations, and what redundant rows contradict one another by is rounding, relative to 1e-9.
  void expectEvaluated(double shareTolerance = 1e-9, double contradictionTolerance = 1e-5) {
    const std::vector<double> force(forces.forces().begin(), forces.forces().end());
    const std::vector<double> margins(forces.marginValues().begin(), forces.marginValues().end());
    std::vector<double> acceleration(velocityCount);
    ASSERT_TRUE(linked.evaluate(at, system.rows, system.problem, acceleration.data(), forces));
    double scale = 0;
    for (const double f : force)
      scale = std::max(scale, std::abs(f));
    EXPECT_GT(scale, 0);
    for (std::size_t i = 0; i < force.size(); ++i)
      EXPECT_NEAR(forces.forces()[i], force[i], shareTolerance * scale) << i;
    for (std::size_t k = 0; k < margins.size(); ++k)
      EXPECT_NEAR(forces.marginValues()[k], margins[k],
                  (forces.margins()[k].limit.row == ModeMargin::contradiction ? contradictionTolerance : 10 * shareTolerance) * scale)
          << k << " of row " << forces.margins()[k].limit.row;
    for (int i = 0; i < velocityCount; ++i)
      EXPECT_NEAR(acceleration[i], expected[i], 1e-9 * (1 + std::abs(expected[i]))) << i;
  }

  // The rods above the floor turn.
  void turn(int lying, double angle) {
    for (int i = 0; i < rods - lying; ++i)
      state[2 + i] += angle * (1 + 0.1 * i);
    at.setPoint(0, state.data());
  }

  Model model;
  InputSignals inputs;
  ModelEvaluation at;
  std::vector<double> parameters, state;
  ContactSystem system;
  ContactMode mode;
  std::vector<std::uint8_t> mask;
  ModeForces forces;
  LinkedForces linked;
  std::vector<double> expected;
};

// All slips are one, whose friction the contacts share.
TEST(LinkedForces, OfAChainThatLiesAndSticksAreThoseOfAllRows) {
  OnFloor chain(30, 0.9);
  chain.expectSame();
  EXPECT_TRUE(chain.forces.redundant());
}

// With less friction some contacts are at their limits, and the others share what is left.
TEST(LinkedForces, WithSaturatedLimitsAreThoseOfAllRows) {
  bool anySaturated = false;
  for (const double mu : {0.9, 0.6, 0.5, 0.45, 0.4, 0.35, 0.32}) {
    OnFloor chain(30, mu);
    if (!chain.solveDense())
      continue;
    std::vector<int> rows;
    std::vector<ForceLimit> saturated;
    ASSERT_TRUE(chain.forces.listEquations(rows, saturated));
    anySaturated = anySaturated || !saturated.empty();
    SCOPED_TRACE(mu);
    chain.expectSame();
  }
  EXPECT_TRUE(anySaturated);
}

// Friction is folded into the normal forces, and may press contacts in: that margin is a determinant.
TEST(LinkedForces, OfAChainThatSlidesAreThoseOfAllRows) {
  OnFloor chain(30, 0.5);
  for (int contact = 0; contact < 30; ++contact)
    chain.slip(contact, 1);
  chain.expectSame();
  EXPECT_FALSE(chain.forces.redundant());
  EXPECT_TRUE(std::any_of(chain.forces.margins().begin(), chain.forces.margins().end(),
                          [](const ModeMargin &margin) { return margin.limit.row == ModeMargin::pressing; }));
}

// What is known of the rows from points before serves at others, to any distance: where rods are parallel in between, too.
TEST(LinkedForces, GoOnAtOtherPoints) {
  for (const bool slides : {true, false}) {
    OnFloor chain(20, 0.5);
    for (int contact = 0; contact < 20 && slides; ++contact)
      chain.slip(contact, 1);
    chain.expectSame();
    for (const double angle : {1e-6, 0.01, -0.2, 0.9, 0.0}) {
      SCOPED_TRACE(angle);
      chain.turn(20, angle);
      ASSERT_TRUE(chain.evaluateDense());
      chain.expectEvaluated();
    }
    std::fill_n(chain.state.begin() + 2, rods, 0.0);
    chain.turn(20, 0);
    ASSERT_TRUE(chain.evaluateDense());
    chain.expectEvaluated();
  }
}

// Rows that were equal, of rods that lie, are no more where one of these lifts its end by so much that forces show it.
void expectDifference(double angle, double forceError) {
  OnFloor chain(20, 0.9);
  chain.linked.setForceError(forceError);
  chain.expectSame();
  chain.state[velocityCount - 1] = angle;
  chain.at.setPoint(0, chain.state.data());
  EXPECT_TRUE(chain.at.dynamics());
  chain.at.contactTerms(chain.mask.data());
  std::vector<double> acceleration(velocityCount);
  EXPECT_FALSE(chain.linked.evaluate(chain.at, chain.system.rows, chain.system.problem, acceleration.data(), chain.forces));
}

TEST(LinkedForces, NoticeThatEqualRowsDiffer) {
  expectDifference(0.1, 1e-5);
  expectDifference(1e-7, 1e-9);
}

// Where the end is lifted by little the mode goes on, with the rows that were equal sharing one force as before.
TEST(LinkedForces, AreSharedByRowsThatAreNearlyEqual) {
  OnFloor chain(20, 0.9);
  chain.linked.setForceError(1e-5);
  chain.expectSame();
  for (const double angle : {1e-12, 1e-9, 1e-7, 1e-9, 0.0}) {
    SCOPED_TRACE(angle);
    chain.state[velocityCount - 1] = chain.state[velocityCount - 8] = angle;
    chain.at.setPoint(0, chain.state.data());
    ASSERT_TRUE(chain.evaluateDense());
    chain.expectEvaluated(1e-9 + 10 * angle, 1e-2);
  }
}

// The shortest motion, in the metric of M, that removes the residuals of the normal rows, or of all: of equal rows these are equal. `lying`
// contacts, at the chain's point.
void expectCorrection(OnFloor &chain, int lying, bool all) {
  const RowMajor M = chainAt(chain.state.data()).mass();
  std::vector<std::uint8_t> takesPart(2 * lying, 1);
  std::vector<double> residual(2 * lying), change(velocityCount, 0.0);
  for (int row = 0; row < 2 * lying; ++row) {
    takesPart[row] = all || row < lying;
    residual[row] = row < lying ? 1e-5 * std::sin(3 * row) : 2e-5;
  }
  ASSERT_TRUE(chain.linked.correct(chain.at, takesPart, residual.data(), change.data()));
  // Slips of nodes that lie are one.
  const int rows = lying + (all ? 1 : 0);
  Eigen::MatrixXd J(rows, velocityCount);
  Eigen::VectorXd right(rows);
  for (int row = 0; row < rows; ++row) {
    J.row(row) = Eigen::Map<const Eigen::RowVectorXd>(chain.system.rows.jacobian(row), velocityCount);
    right[row] = residual[row];
  }
  const Eigen::MatrixXd response = M.ldlt().solve(J.transpose().eval());
  const Eigen::VectorXd expected = response * (J * response).ldlt().solve(right);
  for (int i = 0; i < velocityCount; ++i)
    EXPECT_NEAR(change[i], expected[i], 1e-9 * expected.lpNorm<Eigen::Infinity>()) << i;
}

TEST(LinkedForces, CorrectWhatRowsAreOffBy) {
  constexpr int lying = 20;
  OnFloor chain(lying, 0.9);
  chain.expectSame();
  for (const double angle : {0.0, 0.3}) {
    chain.turn(lying, angle);
    ASSERT_TRUE(chain.evaluateDense());
    chain.expectEvaluated();
    for (const bool all : {false, true, false})
      expectCorrection(chain, lying, all);
  }
}

// What has been factorised for corrections is that of the mode: another one may be corrected before its first evaluation.
TEST(LinkedForces, CorrectTheModeThatHasBegun) {
  constexpr int lying = 20;
  OnFloor chain(lying, 0.5);
  chain.expectSame();
  expectCorrection(chain, lying, false);
  OnFloor other(lying, 0.5);
  for (int contact = 0; contact < lying; ++contact)
    other.slip(contact, 1);
  other.turn(lying, 0.4);
  ASSERT_TRUE(other.solveDense());
  ASSERT_TRUE(chain.linked.choose(other.at, other.system.rows, other.system.problem, other.mode, other.forces));
  std::swap(chain.linked, other.linked);
  expectCorrection(other, lying, false);
}

// Rows of which some follow from others, if not as equal ones, are left to others.
TEST(LinkedForces, DoNotCorrectDependentRows) {
  constexpr int lying = 20;
  OnFloor chain(lying, 0.9);
  chain.linked.setForceError(1e-5);
  chain.expectSame();
  chain.state[velocityCount - 1] = 1e-8;
  chain.at.setPoint(0, chain.state.data());
  EXPECT_TRUE(chain.at.dynamics());
  chain.at.contactTerms(chain.mask.data());
  std::vector<double> acceleration(velocityCount), change(velocityCount, 0.0);
  EXPECT_TRUE(chain.linked.evaluate(chain.at, chain.system.rows, chain.system.problem, acceleration.data(), chain.forces));
  const std::vector<double> residual(2 * lying, 1e-6);
  EXPECT_FALSE(chain.linked.correct(chain.at, std::vector<std::uint8_t>(2 * lying, 1), residual.data(), change.data()));
  EXPECT_EQ(change, std::vector<double>(velocityCount, 0.0));
}

// A small system is left to the dense equations, whose loops are simple.
TEST(LinkedForces, AreNotUsedWhereTheyDoNotPay) {
  OnFloor chain(0, 0.5);
  ASSERT_TRUE(chain.solveDense());
  EXPECT_FALSE(chain.linked.choose(chain.at, chain.system.rows, chain.system.problem, chain.mode, chain.forces));
}

}  // namespace
}  // namespace tf::runtime
