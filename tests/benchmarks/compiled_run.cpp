#include "tests/benchmarks/compiled_run.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace tf::bench {

CompiledRun::CompiledRun(const std::string &library, std::string name, const Settings &settings, double end)
    : name_(std::move(name)), end_(end) {
  tf_simulation *raw = nullptr;
  const tf_status status = tf_load(library.c_str(), &raw);
  simulation_.reset(raw);
  check(status);
  for (const auto &[variable, value] : settings) {
    check(tf_set(raw, variable, value));
  }
}

void CompiledRun::simulate(double tolerance) {
  check(tf_set_tolerance(simulation_.get(), tolerance));
  check(tf_initialise(simulation_.get(), 0));
  check(tf_step(simulation_.get(), end_));
}

double CompiledRun::value(const char *variable) const {
  double value = 0;
  check(tf_get_named(simulation_.get(), variable, &value));
  return value;
}

double CompiledRun::timeOfRest(double tolerance) {
  double time = std::numeric_limits<double>::quiet_NaN();
  const auto note = [](void *data, const tf_event *event) {
    double &first = *static_cast<double *>(data);
    if (event->kind == TF_EVENT_REST && std::isnan(first)) {
      first = event->time;
    }
  };
  check(tf_set_event_callback(simulation_.get(), note, &time));
  simulate(tolerance);
  check(tf_set_event_callback(simulation_.get(), nullptr, nullptr));
  return time;
}

void CompiledRun::check(tf_status status) const {
  if (status != TF_OK) {
    throw std::runtime_error(name_ + ": " + tf_error_text(simulation_.get()));
  }
}

}  // namespace tf::bench
