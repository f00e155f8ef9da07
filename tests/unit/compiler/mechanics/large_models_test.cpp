// Matrices of large models are loops over directions; they are the matrices that would otherwise be written out.
#include "compiler/ir/sweep.h"
#include "tests/unit/compiler/ir/run_sweep.h"
#include "tests/unit/compiler/mechanics/derived_model.h"
#include "tests/unit/compiler/mechanics/function_index.h"

#include <fmt/format.h>

#include <cmath>

namespace tf::test {
namespace {

using enum ir::SymbolKind;

// Relative angles: M, the contacts' rows and all derivatives are full.
std::string chain(int links) {
  return fmt::format(R"(model Chain
  parameter Real l = 0.1, m = 0.2;
  coordinate Real r[2], theta[{0}];
  Real phi[{0}], node[{0} + 1, 2];
  body rod[{0}](each mass = m, position = (node[1:{0}, :] + node[2:{0} + 1, :])/2, angle = phi, each inertia = m*l^2/12);
  gravity weight(acceleration = {{0, -9.81}});
  force damper[{0} - 1](value = -0.1*der(theta[2:{0}]), at = theta[2:{0}]);
  contact floor[{0} + 1](gap = node[:, 2], slip = der(node[:, 1]), each friction = 0.3);
equation
  node[1, :] = r;
  phi[1] = theta[1];
  for i in 2:{0} loop
    phi[i] = phi[i - 1] + theta[i];
  end for;
  for i in 1:{0} loop
    node[i + 1, :] = node[i, :] + l*{{cos(phi[i]), sin(phi[i])}};
  end for;
end Chain;
)",
                     links);
}

class LargeModels : public ::testing::Test {
protected:
  // All buffers of a function.
  static std::vector<std::vector<double>> evaluate(const ir::Function &function, const HybridSystem &system, const Point &point) {
    std::vector<std::vector<double>> buffers;
    for (const int size : function.bufferSizes)
      buffers.emplace_back(static_cast<std::size_t>(size), std::nan(""));
    ir::testing::runSweep(function, system.graph, [&](ir::Symbol symbol) { return point.at(symbol); }, {}, buffers);
    std::vector<ir::NodeId> nodes;
    for (const ir::Store &store : function.stores)
      nodes.push_back(store.node);
    const std::vector<double> values = point.evaluate(system.graph, nodes);
    for (std::size_t k = 0; k < values.size(); ++k)
      buffers[static_cast<std::size_t>(function.stores[k].buffer)][static_cast<std::size_t>(function.stores[k].position)] = values[k];
    return buffers;
  }
};

TEST_F(LargeModels, LoopsGiveTheMatricesThatAreWrittenOut) {
  DerivedModel model(chain(75));
  TF_ASSERT_DERIVED(model);
  HybridSystem writtenOut = *model;
  ASSERT_TRUE(model->mass.empty());
  ASSERT_FALSE(model->contactForce.empty());
  writeOutMatrices(writtenOut);
  EXPECT_EQ(verify(writtenOut), "");
  const std::vector<ir::Function> loops = modelFunctions(*model), straight = modelFunctions(writtenOut);
  const Point point(*model, 3);
  for (const FunctionIndex index : {Dynamics, ContactTerms, DynamicsDerivatives}) {
    ASSERT_TRUE(loops[index].sweep) << index;
    EXPECT_EQ(ir::verify(loops[index], model->graph), "");
    const auto actual = evaluate(loops[index], *model, point), expected = evaluate(straight[index], writtenOut, point);
    ASSERT_EQ(actual.size(), expected.size() + (index == Dynamics ? 1 : 0));  // products, of loops alone
    for (std::size_t b = 0; b < expected.size(); ++b)
      for (std::size_t k = 0; k < expected[b].size(); ++k)
        ASSERT_NEAR(actual[b][k], expected[b][k], 1e-11 * (1 + std::fabs(expected[b][k]))) << index << " out[" << b << "][" << k << ']';
  }
}

// An independent view of the loops of the derivatives: differences of the residual.
TEST_F(LargeModels, DerivativesAreThoseOfTheResidual) {
  DerivedModel model(chain(40));
  TF_ASSERT_DERIVED(model);
  const ir::Function function = modelFunctions(*model)[DynamicsDerivatives];
  ASSERT_TRUE(function.sweep);
  Point point(*model, 4);
  const auto derivative = evaluate(function, *model, point)[0];
  const std::size_t columns = derivative.size() / model->residual.size();
  for (const int column : {0, 5, 41}) {
    double &q = point(Coordinate, column);
    const double value = q, h = 1e-5;
    q = value + h;
    const std::vector<double> above = point.evaluate(model->graph, model->residual);
    q = value - h;
    const std::vector<double> below = point.evaluate(model->graph, model->residual);
    q = value;
    for (std::size_t k = 0; k < above.size(); ++k)
      EXPECT_NEAR(derivative[k * columns + static_cast<std::size_t>(column)], (above[k] - below[k]) / (2 * h), 1e-6) << k;
  }
}

// The yardstick of the issue: what is generated grows with the number of links, not with that of the matrices' entries.
TEST_F(LargeModels, CodeGrowsLinearly) {
  const auto size = [](int links) {
    DerivedModel model(chain(links));
    EXPECT_TRUE(model.system.has_value()) << model.errors();
    std::size_t operations = 0;
    for (const ir::Function &function : modelFunctions(*model)) {
      std::vector<ir::NodeId> nodes;
      for (const ir::Store &store : function.stores)
        nodes.push_back(store.node);
      operations += nodes.size() + function.clears.size();
      if (function.sweep)
        for (const ir::Sweep::Result &result : function.sweep->results)
          nodes.push_back(result.node);
      std::vector<char> isSeen(static_cast<std::size_t>(model->graph.size()), 0);
      while (!nodes.empty()) {
        const ir::NodeId id = nodes.back();
        nodes.pop_back();
        if (isSeen[static_cast<std::size_t>(id)]++ != 0)
          continue;
        ++operations;
        nodes.insert(nodes.end(), model->graph[id].operands, model->graph[id].operands + model->graph[id].arity);
      }
    }
    return static_cast<double>(operations);
  };
  EXPECT_LT(size(160) / size(80), 2.1);
}

TEST_F(LargeModels, IndependentBodiesStayStraightLine) {
  DerivedModel model("model Pile\n coordinate Real p[60, 2];\n body ball[60](each mass = 2, position = p);\nend Pile;\n");
  TF_ASSERT_DERIVED(model);
  EXPECT_TRUE(model->massProduct.empty());
  EXPECT_EQ(model->mass.size(), 120U * 120U);
}

TEST_F(LargeModels, CoordinatesWithoutMassAreFound) {
  DerivedModel model(
      "model Wrong\n coordinate Real x[80], lost;\n Real s[80];\n body b[80](each mass = 1, position = s);\nequation\n s[1] = x[1];\n"
      " for i in 2:80 loop s[i] = s[i - 1] + sin(x[i]); end for;\nend Wrong;\n");
  EXPECT_FALSE(model.system.has_value());
  EXPECT_NE(model.errors().find("'lost'"), std::string::npos) << model.errors();
}

}  // namespace
}  // namespace tf::test
