// check_derivatives MODEL.so: the derivatives of a compiled model against central differences of its own functions, at points around its
// start.
#include "runtime/model/loaded_model.h"
#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/derivative_check.h"

#include <cstdio>
#include <string>
#include <vector>

using tf::runtime::LoadedModel;
using tf::runtime::ModelInstance;
using tf::runtime::Starts;
using tf::runtime::test::EvaluationPoint;

namespace {

constexpr int points = 5;
constexpr double radius = 0.2;  // of the points around the start
constexpr double tolerance = 1e-7;

void around(std::vector<double> &values, const std::vector<double> &centre) {
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = centre[i] + radius * values[i];
}

EvaluationPoint pointNearStart(const ModelInstance &instance, std::uint32_t seed) {
  EvaluationPoint point =
      tf::runtime::test::randomPoint(instance.model(), {instance.parameters().begin(), instance.parameters().end()}, seed);
  const Starts starts = instance.starts(0);
  around(point.in[TF_IN_Q], starts.q);
  around(point.in[TF_IN_V], starts.v);
  around(point.in[TF_IN_Z], starts.z);
  around(point.in[TF_IN_U], starts.u);
  for (double &alpha : point.in[TF_IN_ALPHA])
    alpha = 0.1 + 0.8 * alpha;  // away from the ends, where values are selected
  return point;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: check_derivatives MODEL.so\n");
    return 2;
  }
  const auto loaded = LoadedModel::open(argv[1]);
  if (!loaded) {
    std::fprintf(stderr, "%s\n", loaded.error().c_str());
    return 1;
  }
  const ModelInstance instance(loaded.value().model());
  bool good = true;
  for (std::uint32_t seed = 1; seed <= points; ++seed)
    for (const std::string &failure : tf::runtime::test::checkDerivatives(instance.model(), pointNearStart(instance, seed), tolerance)) {
      std::fprintf(stderr, "point %u: %s\n", seed, failure.c_str());
      good = false;
    }
  return good ? 0 : 1;
}
