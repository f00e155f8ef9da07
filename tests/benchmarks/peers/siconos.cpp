// Siconos: tf_peer_siconos CASE STEP. Moreau-Jean time stepping, theta = 1/2, one-step problem solved to 1e-12.
#include "tests/benchmarks/peers/common.h"

#include <SiconosKernel.hpp>
#include <SolverOptions.h>
#include <cmath>
#include <cstdlib>
#include <string>

namespace {

using Vectors = std::vector<double>;

std::shared_ptr<SiconosVector> vectorOf(const Vectors &values) {
  auto vector = std::make_shared<SiconosVector>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    vector->setValue(i, values[i]);
  }
  return vector;
}

// gap = (r + R(phi) c).y, tangent = (r + R(phi) c).x; q = (x, y, phi)
class CornerOnFloor : public LagrangianScleronomousR {
public:
  CornerOnFloor(double x, double y) : x_(x), y_(y) {}
  void computeh(const BlockVector &q, BlockVector &, SiconosVector &y) override {
    const double c = std::cos(q(2)), s = std::sin(q(2));
    y.setValue(0, q(1) + s * x_ + c * y_);
    y.setValue(1, q(0) + c * x_ - s * y_);
  }
  void computeJachq(const BlockVector &q, BlockVector &) override {
    const double c = std::cos(q(2)), s = std::sin(q(2));
    _jachq->setValue(0, 0, 0);
    _jachq->setValue(0, 1, 1);
    _jachq->setValue(0, 2, c * x_ - s * y_);
    _jachq->setValue(1, 0, 1);
    _jachq->setValue(1, 1, 0);
    _jachq->setValue(1, 2, -s * x_ - c * y_);
  }

private:
  double x_, y_;
};

constexpr double l1 = 0.153, l2 = 0.306, m1 = 0.038, m2 = 0.038, m3 = 0.076, j1 = 7.4e-5, j2 = 5.9e-4, j3 = 2.7e-6;
constexpr double a = 0.05, b = 0.025, d = 0.026, g = 9.81;

// Corner of the slider in the channel; wall 1 above, -1 below.
class CornerInChannel : public LagrangianScleronomousR {
public:
  CornerInChannel(int wall, int side) : wall_(wall), x_(side * a), y_(wall * b) {}
  void computeh(const BlockVector &q, BlockVector &, SiconosVector &y) override {
    const double c = std::cos(q(2)), s = std::sin(q(2));
    y.setValue(0, d - wall_ * (l1 * std::sin(q(0)) + l2 * std::sin(q(1)) + s * x_ + c * y_));
    y.setValue(1, l1 * std::cos(q(0)) + l2 * std::cos(q(1)) + c * x_ - s * y_);
  }
  void computeJachq(const BlockVector &q, BlockVector &) override {
    const double c = std::cos(q(2)), s = std::sin(q(2));
    _jachq->setValue(0, 0, -wall_ * l1 * std::cos(q(0)));
    _jachq->setValue(0, 1, -wall_ * l2 * std::cos(q(1)));
    _jachq->setValue(0, 2, -wall_ * (c * x_ - s * y_));
    _jachq->setValue(1, 0, -l1 * std::sin(q(0)));
    _jachq->setValue(1, 1, -l2 * std::sin(q(1)));
    _jachq->setValue(1, 2, -s * x_ - c * y_);
  }

private:
  double wall_, x_, y_;
};

class SliderCrank : public LagrangianDS {
public:
  SliderCrank() : LagrangianDS(vectorOf({0, 0, 0}), vectorOf({150, -75, 0})) {
    _mass = std::make_shared<SimpleMatrix>(3, 3);
    _mass->zero();
    _fGyr = std::make_shared<SiconosVector>(3);
    _fInt = std::make_shared<SiconosVector>(3);
    _hasConstantMass = false;
  }
  using LagrangianDS::computeMass;
  void computeMass(SP::SiconosVector position) override {
    const double c12 = coupling * std::cos((*position)(0) - (*position)(1));
    _mass->setValue(0, 0, j1 + m1 * l1 * l1 / 4 + (m2 + m3) * l1 * l1);
    _mass->setValue(0, 1, c12);
    _mass->setValue(1, 0, c12);
    _mass->setValue(1, 1, j2 + m2 * l2 * l2 / 4 + m3 * l2 * l2);
    _mass->setValue(2, 2, j3);
    _mass->resetLU();
  }
  void computeMass() override { computeMass(_q[0]); }
  void computeFGyr(SP::SiconosVector position, SP::SiconosVector velocity) override {
    const double s12 = coupling * std::sin((*position)(0) - (*position)(1)), w1 = (*velocity)(0), w2 = (*velocity)(1);
    _fGyr->setValue(0, s12 * w2 * w2);
    _fGyr->setValue(1, -s12 * w1 * w1);
    _fGyr->setValue(2, 0);
  }
  void computeFGyr() override { computeFGyr(_q[0], _q[1]); }
  void computeFInt(double, SP::SiconosVector position, SP::SiconosVector) override {
    _fInt->setValue(0, g * l1 * (m1 / 2 + m2 + m3) * std::cos((*position)(0)));
    _fInt->setValue(1, g * l2 * (m2 / 2 + m3) * std::cos((*position)(1)));
    _fInt->setValue(2, 0);
  }
  void computeFInt(double time) override { computeFInt(time, _q[0], _q[1]); }

private:
  static constexpr double coupling = (m2 / 2 + m3) * l1 * l2;
};

struct Problem {
  double end = 0;
  std::shared_ptr<LagrangianDS> body;
  std::shared_ptr<NonSmoothLaw> law;
  std::vector<std::shared_ptr<Relation>> relations;
  bool friction = true;
};

std::shared_ptr<LagrangianDS> planarBody(double inertia, const Vectors &q, const Vectors &v) {
  auto mass = std::make_shared<SimpleMatrix>(3, 3);
  mass->eye();
  mass->setValue(2, 2, inertia);
  auto body = std::make_shared<LagrangianLinearTIDS>(vectorOf(q), vectorOf(v), mass);
  body->setFExtPtr(vectorOf({0, -g, 0}));
  return body;
}

bool makeProblem(const std::string &name, Problem &problem) {
  if (name == "ball") {
    auto mass = std::make_shared<SimpleMatrix>(1, 1);
    mass->setValue(0, 0, 0.5);
    auto ball = std::make_shared<LagrangianLinearTIDS>(vectorOf({1}), vectorOf({0}), mass);
    ball->setFExtPtr(vectorOf({-0.5 * g}));
    auto rows = std::make_shared<SimpleMatrix>(1, 1);
    rows->setValue(0, 0, 1);
    problem = {3, ball, std::make_shared<NewtonImpactNSL>(0.8), {std::make_shared<LagrangianLinearTIR>(rows)}, false};
    return true;
  }
  if (name == "box") {
    problem = {2, planarBody(1.36 / 12, {0, 1, 0.9}, {3, 0, 4}), std::make_shared<NewtonImpactFrictionNSL>(0, 0, 0.2, 2), {}, true};
    for (const auto &[x, y] : {std::pair(-0.5, -0.3), {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}}) {
      problem.relations.push_back(std::make_shared<CornerOnFloor>(x, y));
    }
    return true;
  }
  if (name == "rod") {
    const double quarter = std::acos(-1.0) / 4;
    problem = {1.5,
               planarBody(1.0 / 12, {0, 0.5 * std::sin(quarter) + 0.5, quarter}, {2, 0, 0}),
               std::make_shared<NewtonImpactFrictionNSL>(0, 0, 0.3, 2),
               {std::make_shared<CornerOnFloor>(-0.5, 0), std::make_shared<CornerOnFloor>(0.5, 0)},
               true};
    return true;
  }
  if (name == "slider-crank") {
    problem = {0.1, std::make_shared<SliderCrank>(), std::make_shared<NewtonImpactFrictionNSL>(0, 0, 0.01, 2), {}, true};
    for (const int wall : {1, -1}) {
      for (const int side : {-1, 1}) {
        problem.relations.push_back(std::make_shared<CornerInChannel>(wall, side));
      }
    }
    return true;
  }
  return false;
}

Vectors run(const std::string &name, double step) {
  Problem problem;
  makeProblem(name, problem);
  auto system = std::make_shared<NonSmoothDynamicalSystem>(0, problem.end);
  system->insertDynamicalSystem(problem.body);
  for (const auto &relation : problem.relations) {
    system->link(std::make_shared<Interaction>(problem.law, relation), problem.body);
  }
  auto integrator = std::make_shared<MoreauJeanOSI>(0.5);
  auto discretisation = std::make_shared<TimeDiscretisation>(0, step);
  std::shared_ptr<OneStepNSProblem> contact;
  if (problem.friction) {
    contact = std::make_shared<FrictionContact>(2, SICONOS_FRICTION_2D_NSGS);
  } else {
    contact = std::make_shared<LCP>();
  }
  contact->numericsSolverOptions()->dparam[SICONOS_DPARAM_TOL] = 1e-12;
  contact->numericsSolverOptions()->iparam[SICONOS_IPARAM_MAX_ITER] = 10000;
  auto simulation = std::make_shared<TimeStepping>(system, discretisation, integrator, contact);
  simulation->setNewtonTolerance(1e-10);
  simulation->setNewtonMaxIteration(20);
  const double start = tf::peers::cpuSeconds();
  while (simulation->hasNextEvent()) {
    simulation->computeOneStep();
    simulation->nextStep();
  }
  Vectors result = {tf::peers::cpuSeconds() - start};
  for (unsigned int i = 0; i < problem.body->dimension(); ++i) {
    result.push_back((*problem.body->q())(i));
  }
  return result;
}

}  // namespace

int main(int argc, char **argv) {
  Problem known;
  if (argc != 3 || !makeProblem(argv[1], known)) {
    return 2;
  }
  const double step = std::atof(argv[2]);
  return tf::peers::answer([&] { return run(argv[1], step); });
}
