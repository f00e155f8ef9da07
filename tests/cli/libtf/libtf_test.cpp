// The C interface on models in memory: results, phases, arguments and errors.
#include "runtime/tf.h"

#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tf::runtime {

namespace {

const double infinity = std::numeric_limits<double>::infinity();

struct Free {
  void operator()(tf_simulation *simulation) const { tf_free(simulation); }
};
using Owned = std::unique_ptr<tf_simulation, Free>;

Owned create(const tf_model &model) {
  tf_simulation *simulation = nullptr;
  EXPECT_EQ(tf_create(&model, &simulation), TF_OK) << tf_error_text(simulation);
  return Owned(simulation);
}

double named(const Owned &simulation, const char *name) {
  double value = 0;
  EXPECT_EQ(tf_get_named(simulation.get(), name, &value), TF_OK) << tf_error_text(simulation.get());
  return value;
}

std::string text(const Owned &simulation) { return tf_error_text(simulation.get()); }

TEST(LibTf, SimulatesAFallWithImpact) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_set_tolerance(particle.get(), 1e-9), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  ASSERT_EQ(tf_step(particle.get(), 0.4), TF_OK) << text(particle);
  EXPECT_NEAR(named(particle, "q[2]"), 1 - 0.5 * 9.81 * 0.16, 1e-8);
  EXPECT_NEAR(named(particle, "depth"), -(1 - 0.5 * 9.81 * 0.16), 1e-8);
  ASSERT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
  EXPECT_EQ(tf_time(particle.get()), 1);
  EXPECT_NEAR(named(particle, "floor.normalForce"), 9.81, 1e-8);
  EXPECT_NEAR(named(particle, "tau"), 2, 1e-8);  // beta = 1/2 and a frozen phase of sqrt(2/g)
  EXPECT_EQ(tf_get_statistics(particle.get())->events[TF_EVENT_IMPACT], 1);
}

// Samples of a run, at equal intervals.
struct Sampler {
  tf_simulation *simulation = nullptr;
  double interval = 0;
  std::vector<double> times = {}, heights = {};

  static double take(void *data, double time) {
    auto &own = *static_cast<Sampler *>(data);
    double height = 0;
    EXPECT_EQ(tf_time(own.simulation), time);
    EXPECT_EQ(tf_get_named(own.simulation, "q[2]", &height), TF_OK);
    EXPECT_EQ(tf_step(own.simulation, 10), TF_BAD_ARGUMENT);  // it can only read
    own.times.push_back(time);
    own.heights.push_back(height);
    return own.interval * static_cast<double>(own.times.size() + 1);
  }
};

TEST(LibTf, TakesSamplesInsideSteps) {
  const Owned particle = create(test::particleModel());
  Sampler samples{particle.get(), 0.125};
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  ASSERT_EQ(tf_run(particle.get(), 1, samples.interval, Sampler::take, &samples), TF_OK) << text(particle);
  EXPECT_EQ(tf_time(particle.get()), 1);
  ASSERT_EQ(samples.times.size(), 7U);
  for (std::size_t k = 0; k < samples.times.size(); ++k) {
    const double t = 0.125 * static_cast<double>(k + 1);
    EXPECT_EQ(samples.times[k], t);
    EXPECT_NEAR(samples.heights[k], std::max(1 - 0.5 * 9.81 * t * t, 0.0), 1e-6) << t;
  }
  EXPECT_LT(tf_get_statistics(particle.get())->steps, 7);
}

TEST(LibTf, TakesASampleAtAnEventAfterIt) {
  const Owned particle = create(test::particleModel());
  double impact = 0;
  const auto note = [](void *data, const tf_event *event) {
    if (event->kind == TF_EVENT_IMPACT)
      *static_cast<double *>(data) = event->time;
  };
  ASSERT_EQ(tf_set_event_callback(particle.get(), note, &impact), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  ASSERT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
  ASSERT_GT(impact, 0);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  struct Sample {
    tf_simulation *simulation;
    double rate = -1;
  } sample{particle.get()};
  const auto take = [](void *data, double) {
    auto &own = *static_cast<Sample *>(data);
    EXPECT_EQ(tf_get_named(own.simulation, "der(q[2])", &own.rate), TF_OK);
    return infinity;
  };
  ASSERT_EQ(tf_run(particle.get(), 1, impact, take, &sample), TF_OK) << text(particle);
  EXPECT_EQ(sample.rate, 0);
}

TEST(LibTf, RefusesSamplesThatGoBack) {
  const Owned particle = create(test::particleModel());
  const auto back = [](void *, double time) { return time; };
  EXPECT_EQ(tf_run(particle.get(), 1, 0.5, back, nullptr), TF_BAD_ARGUMENT);  // before the start
  ASSERT_EQ(tf_initialise(particle.get(), 0.25), TF_OK) << text(particle);
  EXPECT_EQ(tf_run(particle.get(), 1, 0.5, nullptr, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_run(particle.get(), 0.2, 0.5, back, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_run(particle.get(), 1, 0.2, back, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "cannot take a sample at time 0.2: the simulation is at 0.25");
  EXPECT_EQ(tf_run(particle.get(), 1, std::nan(""), back, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_run(particle.get(), 1, 0.5, back, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "cannot take a sample at time 0.5 after that at 0.5");
  EXPECT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
}

TEST(LibTf, EndsWhereTheNextSampleIsNoNumber) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  EXPECT_EQ(tf_run(particle.get(), 1, 0.25, [](void *, double) { return std::nan(""); }, nullptr), TF_TERMINATED);
  EXPECT_LT(tf_time(particle.get()), 0.5);  // the impact ends the step
  EXPECT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
}

TEST(LibTf, SetsParametersStartsAndInputs) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_set(particle.get(), "m", 2), TF_OK);
  ASSERT_EQ(tf_set(particle.get(), "depth", -5), TF_OK);
  ASSERT_EQ(tf_set(particle.get(), "u[1]", 4), TF_OK);
  EXPECT_EQ(tf_get(particle.get(), tf_find(particle.get(), "weight")), 2 * 9.81);  // before the start
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  EXPECT_EQ(named(particle, "q[2]"), 5);
  ASSERT_EQ(tf_step(particle.get(), 0.5), TF_OK) << text(particle);
  EXPECT_NEAR(named(particle, "der(q[1])"), 1, 1e-9);
  // A jump of the input: from now on the other way.
  ASSERT_EQ(tf_set(particle.get(), "u[1]", -4), TF_OK) << text(particle);
  ASSERT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
  EXPECT_NEAR(named(particle, "der(q[1])"), 0, 1e-9);
}

TEST(LibTf, RestoringTakesInputsBack) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_set(particle.get(), "u[1]", 4), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  ASSERT_EQ(tf_step(particle.get(), 0.25), TF_OK) << text(particle);
  std::vector<char> state(tf_state_size(particle.get()) + 1);
  ASSERT_EQ(tf_save_state(particle.get(), state.data() + 1, state.size() - 1), TF_OK) << text(particle);  // of no alignment
  ASSERT_EQ(tf_step(particle.get(), 2), TF_OK) << text(particle);
  std::vector<double> first(static_cast<std::size_t>(test::particleModel().variable_count)), second(first.size());
  ASSERT_EQ(tf_get_all(particle.get(), first.data()), TF_OK);
  ASSERT_EQ(tf_set(particle.get(), "u[1]", 9), TF_OK);
  ASSERT_EQ(tf_restore_state(particle.get(), state.data() + 1, state.size() - 1), TF_OK) << text(particle);
  EXPECT_EQ(tf_time(particle.get()), 0.25);
  ASSERT_EQ(tf_step(particle.get(), 2), TF_OK) << text(particle);
  ASSERT_EQ(tf_get_all(particle.get(), second.data()), TF_OK);
  EXPECT_EQ(first, second);
}

struct Continued {
  const tf_model *model;
  tf_integrator integrator;
};

void PrintTo(const Continued &one, std::ostream *stream) { *stream << one.model->name; }

class LibTfContinuation : public testing::TestWithParam<Continued> {};

// From states saved in flight, in contact and in sliding modes, in the same and in a new simulation.
TEST_P(LibTfContinuation, IsBitIdentical) {
  const tf_model &model = *GetParam().model;
  const Owned run = create(model), fresh = create(model);
  for (const Owned *simulation : {&run, &fresh}) {
    ASSERT_EQ(tf_set_integrator(simulation->get(), GetParam().integrator), TF_OK);
    ASSERT_EQ(tf_set_tolerance(simulation->get(), 1e-7), TF_OK);
    ASSERT_EQ(tf_initialise(simulation->get(), 0), TF_OK) << text(*simulation);
  }
  std::vector<double> first(static_cast<std::size_t>(model.variable_count)), again(first.size());
  std::vector<char> state(tf_state_size(run.get()));
  for (double time = 0; time < 1.9; time += 0.3) {
    ASSERT_EQ(tf_step(run.get(), time), TF_OK) << text(run);
    ASSERT_EQ(tf_save_state(run.get(), state.data(), state.size()), TF_OK) << text(run);
    ASSERT_EQ(tf_step(run.get(), time + 0.7), TF_OK) << text(run);
    ASSERT_EQ(tf_get_all(run.get(), first.data()), TF_OK);
    for (const Owned *simulation : {&fresh, &run}) {
      ASSERT_EQ(tf_restore_state(simulation->get(), state.data(), state.size()), TF_OK) << text(*simulation);
      EXPECT_EQ(tf_time(simulation->get()), time);
      ASSERT_EQ(tf_step(simulation->get(), time + 0.7), TF_OK) << text(*simulation);
      ASSERT_EQ(tf_get_all(simulation->get(), again.data()), TF_OK);
      EXPECT_EQ(first, again) << "from " << time;
    }
    ASSERT_EQ(tf_restore_state(run.get(), state.data(), state.size()), TF_OK);
  }
}

std::vector<Continued> continuedRuns() {
  std::vector<Continued> runs;
  for (const tf_model *model : {&test::particleModel(), &test::beltModel(), &test::relayModel(), &test::rodModel(), &test::boxModel()})
    for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_CVODE, TF_EXPLICIT})
      runs.push_back({model, integrator});
  return runs;
}

std::string nameOfRun(const testing::TestParamInfo<Continued> &run) {
  const char *const integrators[] = {"Auto", "Step", "Cvode", "Explicit"};
  return std::string(run.param.model->name) + integrators[run.param.integrator];
}

INSTANTIATE_TEST_SUITE_P(All, LibTfContinuation, testing::ValuesIn(continuedRuns()), nameOfRun);

TEST(LibTf, SavedStatesHoldSensitivitiesAndTheEnergyBalance) {
  const Owned run = create(test::particleModel()), fresh = create(test::particleModel()), plain = create(test::particleModel());
  const char *const names[] = {"g", "mu", "der(q[1])"};
  for (const Owned *simulation : {&run, &fresh}) {
    ASSERT_EQ(tf_set(simulation->get(), "mu", 0.3), TF_OK);
    ASSERT_EQ(tf_set(simulation->get(), "der(q[1])", 2), TF_OK);
    ASSERT_EQ(tf_set_sensitivities(simulation->get(), names, std::size(names)), TF_OK);
    ASSERT_EQ(tf_set_energy_balance(simulation->get(), 1), TF_OK);
    ASSERT_EQ(tf_initialise(simulation->get(), 0), TF_OK) << text(*simulation);
  }
  const auto count = static_cast<std::size_t>(test::particleModel().variable_count);
  const auto results = [&](const Owned &simulation) {
    std::vector<double> all(count * (1 + std::size(names)));
    EXPECT_EQ(tf_get_all(simulation.get(), all.data()), TF_OK);
    for (std::size_t k = 0; k < std::size(names); ++k)
      EXPECT_EQ(tf_get_sensitivity(simulation.get(), k, all.data() + count * (k + 1)), TF_OK) << text(simulation);
    return all;
  };
  for (const double time : {0.2, 0.6}) {
    ASSERT_EQ(tf_step(run.get(), time), TF_OK) << text(run);
    std::vector<char> state(tf_state_size(run.get()));
    ASSERT_EQ(tf_save_state(run.get(), state.data(), state.size()), TF_OK);
    const std::vector<double> here = results(run);
    ASSERT_EQ(tf_step(run.get(), 0.9), TF_OK) << text(run);
    const std::vector<double> there = results(run);
    for (const Owned *simulation : {&fresh, &run}) {
      ASSERT_EQ(tf_restore_state(simulation->get(), state.data(), state.size()), TF_OK) << text(*simulation);
      EXPECT_EQ(results(*simulation), here) << time;
      ASSERT_EQ(tf_step(simulation->get(), 0.9), TF_OK) << text(*simulation);
      EXPECT_EQ(results(*simulation), there) << time;
    }
    ASSERT_EQ(tf_restore_state(run.get(), state.data(), state.size()), TF_OK);
    // One without them has no place for them.
    ASSERT_EQ(tf_set(plain.get(), "mu", 0.3), TF_OK);
    ASSERT_EQ(tf_initialise(plain.get(), 0), TF_OK);
    EXPECT_EQ(tf_restore_state(plain.get(), state.data(), state.size()), TF_BAD_ARGUMENT);
  }
}

TEST(LibTf, RefusesStatesOfOtherRuns) {
  const Owned particle = create(test::particleModel()), heavy = create(test::particleModel()), box = create(test::boxModel());
  ASSERT_EQ(tf_set(heavy.get(), "m", 5), TF_OK);
  for (const Owned *simulation : {&particle, &heavy, &box})
    ASSERT_EQ(tf_initialise(simulation->get(), 0), TF_OK) << text(*simulation);
  std::vector<char> state(tf_state_size(particle.get()));
  EXPECT_EQ(tf_save_state(particle.get(), state.data(), state.size() - 1), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "the state needs " + std::to_string(state.size()) + " bytes");
  ASSERT_EQ(tf_save_state(particle.get(), state.data(), state.size()), TF_OK);
  EXPECT_EQ(tf_restore_state(heavy.get(), state.data(), state.size()), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(heavy), "the state is of another model, of other parameters or of a run with other sensitivities or energy balance");
  EXPECT_EQ(tf_restore_state(box.get(), state.data(), state.size()), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_restore_state(particle.get(), state.data(), state.size() - 1), TF_BAD_ARGUMENT);
  state.back() = static_cast<char>(state.back() + 1);
  EXPECT_EQ(tf_restore_state(particle.get(), state.data(), state.size()), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "the saved state is damaged");
  state[0] = 'x';
  EXPECT_EQ(tf_restore_state(particle.get(), state.data(), state.size()), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "this is not a saved state");
  EXPECT_EQ(tf_restore_state(particle.get(), nullptr, 0), TF_BAD_ARGUMENT);
}

TEST(LibTf, ChecksPhases) {
  const Owned particle = create(test::particleModel());
  double value = 0;
  EXPECT_EQ(tf_step(particle.get(), 1), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "call tf_initialise first");
  EXPECT_EQ(tf_get_named(particle.get(), "q[1]", &value), TF_BAD_ARGUMENT);
  EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(std::isnan(tf_time(particle.get())));
  EXPECT_EQ(tf_state_size(particle.get()), 0u);
  EXPECT_EQ(tf_get_statistics(particle.get())->steps, 0);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  ASSERT_EQ(tf_step(particle.get(), 0.1), TF_OK);
  EXPECT_EQ(tf_step(particle.get(), 0.05), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "cannot step to time 0.05: the simulation is at 0.1");
  EXPECT_EQ(tf_step(particle.get(), infinity), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_step(particle.get(), 0.1), TF_OK);  // where it is
}

TEST(LibTf, StartsAgain) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  ASSERT_EQ(tf_step(particle.get(), 1), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  EXPECT_EQ(named(particle, "q[2]"), 1);
  EXPECT_EQ(tf_time(particle.get()), 0);
  EXPECT_EQ(tf_get_statistics(particle.get())->events[TF_EVENT_IMPACT], 0);
}

TEST(LibTf, RunsAreTheSameWhateverWasRunBefore) {
  std::vector<double> values[2];
  for (std::vector<double> &result : values) {
    const Owned box = create(test::boxModel());
    result.resize(static_cast<std::size_t>(test::boxModel().variable_count));
    if (&result == &values[1]) {
      ASSERT_EQ(tf_set(box.get(), "mu", 0.9), TF_OK);
      ASSERT_EQ(tf_initialise(box.get(), 0), TF_OK);
      ASSERT_EQ(tf_step(box.get(), 2), TF_OK) << text(box);
      ASSERT_EQ(tf_set(box.get(), "mu", 0.2), TF_OK);
    }
    ASSERT_EQ(tf_initialise(box.get(), 0), TF_OK);
    ASSERT_EQ(tf_step(box.get(), 2), TF_OK) << text(box);
    ASSERT_EQ(tf_get_all(box.get(), result.data()), TF_OK);
  }
  EXPECT_EQ(values[0], values[1]);
}

TEST(LibTf, SettingsEndTheRun) {
  const Owned particle = create(test::particleModel());
  const auto ended = [&](tf_status status) {
    EXPECT_EQ(status, TF_OK) << text(particle);
    EXPECT_EQ(tf_step(particle.get(), 1), TF_BAD_ARGUMENT);
    EXPECT_EQ(text(particle), "call tf_initialise first");
    EXPECT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  };
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  ended(tf_set(particle.get(), "g", 5));
  ended(tf_set(particle.get(), "q[2]", 3));
  EXPECT_EQ(named(particle, "q[2]"), 3);
  ended(tf_set_tolerance(particle.get(), 1e-3));
  ended(tf_set_integrator(particle.get(), TF_STEP));
  ended(tf_set_step_options(particle.get(), 2, 0));
  ended(tf_set_longest_step(particle.get(), 0.5));
  EXPECT_EQ(tf_set(particle.get(), "mu", -1), TF_BAD_ARGUMENT);  // refused: the run goes on
  EXPECT_EQ(tf_set(particle.get(), "u[1]", 1), TF_OK);
  EXPECT_EQ(tf_step(particle.get(), 0.1), TF_OK);
}

TEST(LibTf, ChecksArguments) {
  tf_simulation *none = nullptr;
  EXPECT_EQ(tf_load(nullptr, &none), TF_BAD_ARGUMENT);
  EXPECT_STREQ(tf_error_text(none), "the path of the model is missing");
  EXPECT_EQ(tf_get_model(none), nullptr);
  EXPECT_EQ(tf_initialise(none, 0), TF_BAD_ARGUMENT);
  EXPECT_STREQ(tf_error_text(none), "no model was loaded");
  EXPECT_EQ(tf_find(none, "x"), -1);
  tf_free(none);
  EXPECT_EQ(tf_load("model.so", nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_create(nullptr, &none), TF_BAD_ARGUMENT);
  tf_free(none);
  EXPECT_EQ(tf_load("no such file.so", &none), TF_BAD_ARGUMENT);
  EXPECT_STREQ(tf_error_text(none), "cannot load 'no such file.so': No such file or directory");
  tf_free(none);
  tf_free(nullptr);
  EXPECT_EQ(tf_step(nullptr, 1), TF_BAD_ARGUMENT);
  EXPECT_TRUE(std::isnan(tf_time(nullptr)));
  EXPECT_STRNE(tf_error_text(nullptr), "");
  const Owned particle = create(test::particleModel());
  EXPECT_EQ(tf_set(particle.get(), nullptr, 1), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_find(particle.get(), nullptr), -1);
  EXPECT_EQ(tf_initialise(particle.get(), infinity), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_tolerance(particle.get(), 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_tolerance(particle.get(), std::nan("")), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_step_options(particle.get(), 5, 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_step_options(particle.get(), 1, -1), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_longest_step(particle.get(), 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_longest_step(particle.get(), std::nan("")), TF_BAD_ARGUMENT);
  EXPECT_TRUE(std::isnan(tf_get(particle.get(), -1)));
  EXPECT_TRUE(std::isnan(tf_get(particle.get(), 1000)));
  EXPECT_EQ(tf_set(particle.get(), "muu", 1), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "model 'Particle' has no variable 'muu'; did you mean 'mu'?");
}

TEST(LibTf, ChecksInputs) {
  const Owned particle = create(test::particleModel());
  const double times[] = {0, 1, 0.5}, values[] = {0, 1, 2};
  EXPECT_EQ(tf_set_input_table(particle.get(), "u[1]", times, values, 3, 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "the table of 'u[1]': the times of an input table must not decrease: point 3 is at 0.5, after 1");
  EXPECT_EQ(tf_set_input_table(particle.get(), "u[1]", times, values, 0, 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(tf_set_input_table(particle.get(), "u[3]", times, values, 2, 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "model 'Particle' has no input 'u[3]'; did you mean 'u[1]'?");
  EXPECT_EQ(tf_set_input_table(particle.get(), "q[1]", times, values, 2, 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "'q[1]' is not an input");
  EXPECT_EQ(tf_set_input_callback(particle.get(), "u[1]", nullptr, nullptr, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "the callback for 'u[1]' is missing");
}

TEST(LibTf, LinearTablesMoveTheParticle) {
  const Owned particle = create(test::particleModel());
  const double times[] = {0, 1}, values[] = {0, 6};
  ASSERT_EQ(tf_set_tolerance(particle.get(), 1e-9), TF_OK);
  ASSERT_EQ(tf_set_input_table(particle.get(), "u[1]", times, values, 2, 1), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  ASSERT_EQ(tf_step(particle.get(), 2), TF_OK) << text(particle);
  EXPECT_NEAR(named(particle, "der(q[1])"), 9, 1e-8);
}

TEST(LibTf, ReportsWhyInitialisationFails) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_set(particle.get(), "m", 0), TF_OK);
  EXPECT_EQ(tf_initialise(particle.get(), 0), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "'rate', which is computed from other parameters, has no value (NaN)");
  ASSERT_EQ(tf_set(particle.get(), "m", 1), TF_OK);
  ASSERT_EQ(tf_set(particle.get(), "q[2]", -1), TF_OK);
  EXPECT_EQ(tf_initialise(particle.get(), 0), TF_FAILED);
  EXPECT_NE(text(particle).find("'floor'"), std::string::npos) << text(particle);
  EXPECT_EQ(tf_step(particle.get(), 1), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "the simulation was not initialised: tf_initialise failed");
  ASSERT_EQ(tf_set(particle.get(), "q[2]", 1), TF_OK);
  EXPECT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
}

struct Observed {
  tf_simulation *simulation;
  std::vector<int> kinds;
  double heightAtImpact = -1;
  tf_status nested = TF_OK;
};

TEST(LibTf, EventCallbacksReadValuesButCannotStep) {
  const Owned particle = create(test::particleModel());
  Observed observed{particle.get(), {}, -1, TF_OK};
  const auto observe = [](void *data, const tf_event *event) {
    auto &seen = *static_cast<Observed *>(data);
    seen.kinds.push_back(event->kind);
    seen.heightAtImpact = tf_get(seen.simulation, tf_find(seen.simulation, "q[2]"));
    seen.nested = tf_step(seen.simulation, 5);
  };
  ASSERT_EQ(tf_set_event_callback(particle.get(), observe, &observed), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  ASSERT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
  ASSERT_FALSE(observed.kinds.empty());
  EXPECT_EQ(observed.kinds[0], TF_EVENT_IMPACT);
  EXPECT_NEAR(observed.heightAtImpact, 0, 1e-8);
  EXPECT_EQ(observed.nested, TF_BAD_ARGUMENT);
}

struct JumpOfVelocity {
  tf_simulation *simulation;
  double before = 0, after = 0;
};

TEST(LibTf, EventCallbacksSeeBothSidesOfAnImpact) {
  const Owned particle = create(test::particleModel());
  JumpOfVelocity jump{particle.get()};
  const auto observe = [](void *data, const tf_event *event) {
    auto &seen = *static_cast<JumpOfVelocity *>(data);
    if (event->kind != TF_EVENT_IMPACT)
      return;
    std::vector<double> values(static_cast<std::size_t>(test::particleModel().variable_count));
    const auto velocity = static_cast<std::size_t>(tf_find(seen.simulation, "der(q[2])"));
    ASSERT_EQ(tf_get_all_before(seen.simulation, values.data()), TF_OK) << tf_error_text(seen.simulation);
    seen.before = values[velocity];
    ASSERT_EQ(tf_get_all(seen.simulation, values.data()), TF_OK);
    seen.after = values[velocity];
  };
  ASSERT_EQ(tf_set_tolerance(particle.get(), 1e-9), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  ASSERT_EQ(tf_set_event_callback(particle.get(), observe, &jump), TF_OK);  // also while it runs
  ASSERT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
  EXPECT_NEAR(jump.before, -std::sqrt(2 * 9.81), 1e-8);
  EXPECT_NEAR(jump.after, 0, 1e-8);
  double values[100];
  EXPECT_EQ(tf_get_all_before(particle.get(), values), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "values before an event are known in the event callback only");
}

TEST(LibTf, ExceptionsOfCallbacksBecomeErrors) {
  const Owned particle = create(test::particleModel());
  const auto value = [](void *, double, double) -> double { throw std::runtime_error("no value today"); };
  ASSERT_EQ(tf_set_input_callback(particle.get(), "u[1]", value, nullptr, nullptr), TF_OK);
  EXPECT_EQ(tf_initialise(particle.get(), 0), TF_FAILED);
  EXPECT_EQ(text(particle), "no value today");
}

TEST(LibTf, MissingNamesAndPlacesAreErrors) {
  const Owned particle = create(test::particleModel());
  EXPECT_EQ(tf_set_sensitivities(particle.get(), nullptr, 1), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "a name is missing");
  const char *const names[] = {"g", nullptr};
  EXPECT_EQ(tf_set_sensitivities(particle.get(), names, 2), TF_BAD_ARGUMENT);
  ASSERT_EQ(tf_set_sensitivities(particle.get(), names, 1), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  EXPECT_EQ(tf_get_sensitivity(particle.get(), 0, nullptr), TF_BAD_ARGUMENT);
  EXPECT_EQ(text(particle), "the array for the values is missing");
}

TEST(LibTf, BreakpointsThatAreNotLaterAreErrors) {
  const Owned particle = create(test::particleModel());
  const auto value = [](void *, double, double) { return 0.0; };
  const auto stays = [](void *, double time) { return time < 0.25 ? 0.25 : time; };
  ASSERT_EQ(tf_set_input_callback(particle.get(), "u[1]", value, stays, nullptr), TF_OK);
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK) << text(particle);
  EXPECT_EQ(tf_step(particle.get(), 1), TF_FAILED);
  EXPECT_EQ(text(particle), "the breakpoint of 'u[1]' after time 0.25 cannot be at 0.25");
  EXPECT_EQ(tf_time(particle.get()), 0.25);
}

// Also where the step of the sample goes to the end.
TEST(LibTf, ASampleMayEndTheRunInItsLastStep) {
  const Owned particle = create(test::particleModel());
  ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
  const auto ends = [](void *, double) { return std::numeric_limits<double>::quiet_NaN(); };
  EXPECT_EQ(tf_run(particle.get(), 0.3, 0.2, ends, nullptr), TF_TERMINATED);
}

// Throws at its first call once it is armed; a run goes on from where that has ended it as if nothing had been.
struct ThrowsOnce {
  bool isArmed = false;

  void call() {
    if (std::exchange(isArmed, false))
      throw std::runtime_error("not now");
  }
  static double sample(void *data, double time) {
    static_cast<ThrowsOnce *>(data)->call();
    return time + 0.01;
  }
  static void event(void *data, const tf_event *) { static_cast<ThrowsOnce *>(data)->call(); }
  static double input(void *data, double, double) {
    static_cast<ThrowsOnce *>(data)->call();
    return 0;
  }
};

// The particle falls on the floor at 0.45.
class LibTfThrow : public testing::Test {
protected:
  void SetUp() override { ASSERT_EQ(tf_set_tolerance(particle.get(), 1e-9), TF_OK); }

  void initialise() {
    ASSERT_EQ(tf_initialise(particle.get(), 0), TF_OK);
    once.isArmed = true;
  }

  void expectToGoOn(tf_status status, double earliest, double latest) {
    EXPECT_EQ(status, TF_FAILED);
    EXPECT_EQ(text(particle), "not now");
    EXPECT_FALSE(once.isArmed);
    EXPECT_GE(tf_time(particle.get()), earliest);
    EXPECT_LE(tf_time(particle.get()), latest);
    ASSERT_EQ(tf_step(particle.get(), 1), TF_OK) << text(particle);
    EXPECT_NEAR(named(particle, "q[2]"), 0, 1e-10);
    EXPECT_NEAR(named(particle, "q[1]"), undisturbed(), 1e-9);
    EXPECT_EQ(tf_get_statistics(particle.get())->events[TF_EVENT_IMPACT], 1);
  }

  static double undisturbed() {
    const Owned other = create(test::particleModel());
    EXPECT_EQ(tf_set_tolerance(other.get(), 1e-9), TF_OK);
    EXPECT_EQ(tf_initialise(other.get(), 0), TF_OK);
    EXPECT_EQ(tf_step(other.get(), 1), TF_OK);
    return named(other, "q[1]");
  }

  ThrowsOnce once;
  Owned particle = create(test::particleModel());
};

TEST_F(LibTfThrow, InASampleEndsTheRunBehindItsStep) {
  initialise();
  expectToGoOn(tf_run(particle.get(), 1, 0.105, ThrowsOnce::sample, &once), 0.105, 0.5);
}

TEST_F(LibTfThrow, InAnEventEndsTheRunBehindIt) {
  ASSERT_EQ(tf_set_event_callback(particle.get(), ThrowsOnce::event, &once), TF_OK);
  initialise();
  const double impact = std::sqrt(2 / 9.81);
  expectToGoOn(tf_step(particle.get(), 1), impact - 1e-9, impact + 1e-9);
}

TEST_F(LibTfThrow, InAnInputEndsTheRunAtTheLastGoodPoint) {
  ASSERT_EQ(tf_set_input_callback(particle.get(), "u[1]", ThrowsOnce::input, nullptr, &once), TF_OK);
  initialise();
  expectToGoOn(tf_step(particle.get(), 1), 0, 0.5);
}

TEST(LibTf, DifferentSimulationsOfAModelAreIndependent) {
  const Owned one = create(test::particleModel()), two = create(test::particleModel());
  ASSERT_EQ(tf_set(one.get(), "g", 1), TF_OK);
  for (const Owned *simulation : {&one, &two}) {
    ASSERT_EQ(tf_initialise(simulation->get(), 0), TF_OK);
    ASSERT_EQ(tf_step(simulation->get(), 0.4), TF_OK);
  }
  EXPECT_NEAR(named(one, "q[2]"), 1 - 0.5 * 0.16, 1e-8);
  EXPECT_NEAR(named(two, "q[2]"), 1 - 0.5 * 9.81 * 0.16, 1e-8);
}

}  // namespace

}  // namespace tf::runtime
