#include "runtime/integrate/row_system.h"

#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"
#include "tests/unit/runtime/model_tables.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

namespace tf::runtime {
namespace {

TEST(RowSystem, RowsThatAreNoMoreExertNoForces) {
  const tf_model &model = test::boxModel();
  const ModelInstance instance(model);
  const InputSignals inputs(model.nu);
  ModelEvaluation at(model, inputs);
  ASSERT_TRUE(at.setParameters(instance.parameters().data()));
  at.setSegment(0.5);
  const std::vector<double> state = {0, 0.3, 0, 0.7, 0, 0, 0}, forces = {1, 2, 3, 4};
  at.setPoint(0, state.data());
  ASSERT_TRUE(at.dynamics());
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(model.nc) + model.nf, 1);
  at.contactTerms(all.data());
  RowSystem rows;
  ContactProblem problem;
  problem.resize(2, 2);
  rows.choose(model, {0, 1}, {0, 1}, problem);
  rows.assemble(at, problem.delassus, problem);
  std::vector<double> acceleration(model.nv, 0.0);
  rows.accelerate(forces.data(), acceleration.data());
  EXPECT_TRUE(std::any_of(acceleration.begin(), acceleration.end(), [](double a) { return a != 0; }));
  problem.resize(0, 0);
  rows.choose(model, {}, {}, problem);
  const std::vector<double> before = acceleration;
  rows.accelerate(forces.data(), acceleration.data());
  EXPECT_EQ(acceleration, before);
}

// A model of so many velocities and contacts with one slip each; what its functions would give is set by the tests.
class WideModel {
public:
  WideModel(int velocities, int contacts) {
    std::vector<std::string> names;
    names.reserve(velocities);
    for (int i = 0; i < velocities; ++i)
      names.push_back("q" + std::to_string(i));
    tables_.coordinates(names, "m");
    for (int i = 0; i < contacts; ++i)
      tables_.contact("c" + std::to_string(i), 1);
    tables_.finish();
  }
  [[nodiscard]] const tf_model &model() { return tables_.model(); }

private:
  test::ModelTables tables_{"Wide", ""};
};

// D and W Jᵀ λ are those of all rows, though slips that are equal, or all but, go through the factorisation once.
TEST(RowSystem, EqualRowsCount) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  constexpr int contacts = 5;
  for (const int nv : {9, 20, 60}) {
    WideModel wide(nv, contacts);
    const tf_model &model = wide.model();
    const InputSignals inputs(0);
    ModelEvaluation at(model, inputs);
    const RowMajor root = RowMajor::Random(nv, nv), mass = root * root.transpose() + RowMajor::Identity(nv, nv);
    ASSERT_TRUE(at.mobility.setMass(mass.data()));
    RowMajor rows = RowMajor::Random(2 * contacts, nv);
    rows.row(contacts + 2) = rows.row(contacts + 1) * (1 + 1e-16);
    rows.row(contacts + 3) = rows.row(contacts + 1);
    rows(contacts + 3, nv - 1) += 1e-17;
    rows.row(contacts + 4) = rows.row(contacts);
    rows(contacts + 4, nv - 1) += 1e-9;
    std::copy_n(rows.data(), contacts * nv, at.normal.begin());
    std::copy_n(rows.data() + contacts * nv, contacts * nv, at.tangent.begin());
    std::vector<int> all(contacts);
    std::iota(all.begin(), all.end(), 0);
    ContactProblem problem;
    problem.resize(contacts, contacts);
    RowSystem system;
    system.choose(model, all, all, problem);
    system.assemble(at, problem.delassus, problem);
    const Eigen::MatrixXd response = mass.llt().solve(rows.transpose()), expected = rows * response;
    const double size = expected.cwiseAbs().maxCoeff();
    for (int i = 0; i < 2 * contacts; ++i)
      for (int j = 0; j < 2 * contacts; ++j)
        EXPECT_NEAR(problem.delassus(i, j), expected(i, j), 1e-11 * size) << nv << ": " << i << ", " << j;
    EXPECT_EQ(problem.delassus(contacts + 2, 0), problem.delassus(contacts + 1, 0));
    EXPECT_EQ(problem.delassus(contacts + 3, contacts + 2), problem.delassus(contacts + 1, contacts + 1));
    EXPECT_NE(problem.delassus(contacts + 4, 0), problem.delassus(contacts, 0));
    const Eigen::VectorXd forces = Eigen::VectorXd::Random(2 * contacts);
    Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(nv);
    system.accelerate(forces.data(), acceleration.data());
    EXPECT_LT((acceleration - response * forces).norm(), 1e-11 * (response * forces).norm()) << nv;
  }
}

}  // namespace
}  // namespace tf::runtime
