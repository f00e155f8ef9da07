// Generated functions of examples/chain.tf against the same equations written by hand; both compute every entry from the parameters.
#include "runtime/tf.h"
#include "tests/benchmarks/hand_written/chain_equations.h"
#include "tests/benchmarks/measurement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <stdexcept>

namespace tf::bench {

namespace {

struct Free {
  void operator()(tf_simulation *simulation) const { tf_free(simulation); }
};

// The arguments of a compiled chain at a moving state.
struct Arguments {
  double time = 0;
  std::array<double, 5> q{0.1, 0.2, 0.9, 0.65, 0.4}, v{0.5, -0.3, 1.1, -0.7, 2.3};
  std::vector<double> parameters;
  std::array<const double *, TF_IN_COUNT> in{};

  explicit Arguments(const tf_model &model) : parameters(model.parameters, model.parameters + model.np) {
    in[TF_IN_TIME] = &time;
    in[TF_IN_Q] = q.data();
    in[TF_IN_V] = v.data();
    in[TF_IN_P] = parameters.data();
    double *out[] = {parameters.data()};
    for (int i = 0; i < model.binding_depth; ++i) {
      model.bindings(in.data(), out, nullptr);
    }
  }
};

struct Outputs {
  std::array<double, 25> mass{};
  std::array<double, 5> force{};
  std::array<double, 20> normal{}, tangent{};
  std::array<double, 4> normalBias{}, tangentBias{}, friction{}, bound{};
  double states = 0;
};

double difference(const Outputs &a, const Outputs &b) {
  double worst = 0;
  const auto compare = [&](const auto &x, const auto &y) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      worst = std::max(worst, std::abs(x[i] - y[i]));
    }
  };
  compare(a.mass, b.mass);
  compare(a.force, b.force);
  compare(a.normal, b.normal);
  compare(a.tangent, b.tangent);
  compare(a.normalBias, b.normalBias);
  compare(a.tangentBias, b.tangentBias);
  return worst;
}

Measurement ratio(const std::string &name, double generated, double hand) {
  return {.name = name,
          .unit = "ratio",
          .value = generated / hand,
          .bar = 1.2,
          .note = fmt::format("{:.1f} ns against {:.1f} ns", 1e9 * generated, 1e9 * hand)};
}

}  // namespace

std::vector<Measurement> rightHandSide(const Setup &setup) {
  tf_simulation *raw = nullptr;
  const tf_status status = tf_load(compileModel(setup, TF_SOURCE_DIR "/examples/chain.tf").c_str(), &raw);
  const std::unique_ptr<tf_simulation, Free> simulation(raw);
  if (status != TF_OK) {
    throw std::runtime_error(tf_error_text(raw));
  }
  const tf_model &model = *tf_get_model(raw);
  if (model.nv != 5 || model.nc != 4 || model.nt != 4 || model.ns != 0 || model.nz != 0 || model.nu != 0) {
    throw std::runtime_error("examples/chain.tf is not the chain that was worked out by hand");
  }
  const Arguments arguments(model);
  const hand_written::ChainParameters parameters{.m = 1.0 / 3, .l = 1.0 / 3, .d = 0.002, .g = 9.81};
  const double *q = arguments.q.data(), *v = arguments.v.data();
  Outputs generated, hand;
  double *dynamicsOut[] = {generated.mass.data(), generated.force.data(), &generated.states};
  double *contactsOut[] = {generated.normal.data(),      generated.normalBias.data(), generated.tangent.data(),
                           generated.tangentBias.data(), generated.friction.data(),   generated.bound.data()};
  const std::array<std::uint8_t, 4> all{1, 1, 1, 1};
  const auto generatedDynamics = [&] { model.dynamics(arguments.in.data(), dynamicsOut, nullptr); };
  const auto generatedContacts = [&] { model.contact_terms(arguments.in.data(), contactsOut, all.data()); };
  const auto handDynamics = [&] { hand_written::chainDynamics(parameters, q, v, hand.mass.data(), hand.force.data()); };
  const auto handContacts = [&] {
    hand_written::chainContacts(parameters, q, v, hand.normal.data(), hand.normalBias.data(), hand.tangent.data(), hand.tangentBias.data());
  };
  const std::vector<double> seconds = cpuPerCall({generatedDynamics, handDynamics, generatedContacts, handContacts});
  std::vector<Measurement> out = {ratio("M and f of a chain of 3, generated to hand-written", seconds[0], seconds[1]),
                                  ratio("contact rows of a chain of 3, generated to hand-written", seconds[2], seconds[3])};
  if (const double error = difference(generated, hand); error > 1e-12) {
    throw std::runtime_error(fmt::format("generated and hand-written equations of the chain differ by {}", error));
  }
  return out;
}

}  // namespace tf::bench
