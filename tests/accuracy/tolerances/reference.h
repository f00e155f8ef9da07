// What an example's solution is, known independently of the project: states at some times and the times of its events.
#pragma once

#include "runtime/tf.h"
#include "tests/accuracy/support/gauss_reference.h"

#include <limits>
#include <string>
#include <vector>

namespace tf::test {

struct Sample {
  double time = 0;
  std::vector<double> values;  // in the order of the reference's variables
};

struct ReferenceEvent {
  double time = 0;
  tf_event_kind kind = TF_EVENT_COUNT;  // TF_EVENT_COUNT: of any kind
  bool isRequired = true;               // false: may be missing from the log (impacts that are summed up)
};

struct Reference {
  std::vector<std::string> variables = {};
  std::vector<Sample> samples = {};
  std::vector<ReferenceEvent> events = {};
  double error = 0;                                              // of the reference itself
  double eventsUntil = std::numeric_limits<double>::infinity();  // beyond it the reference knows no events

  template <class... Values> void add(Number time, Values... values) {
    samples.push_back({static_cast<double>(time), {static_cast<double>(values)...}});
  }
  void addEvent(Number time, tf_event_kind kind, bool isRequired = true) {
    events.push_back({static_cast<double>(time), kind, isRequired});
  }
};

// count times, the last one is the end.
[[nodiscard]] inline std::vector<double> uniformTimes(double end, int count) {
  std::vector<double> times;
  for (int i = 1; i <= count; ++i)
    times.push_back(end * i / count);
  return times;
}

// The zero of a function in an interval where it changes its sign.
template <class Function> [[nodiscard]] Number zero(const Function &function, Number low, Number high) {
  const bool isNegative = function(low) < 0;
  for (int i = 0; i < 200; ++i) {
    const Number middle = (low + high) / 2;
    ((function(middle) < 0) == isNegative ? low : high) = middle;
  }
  return high;
}

// An event-driven reference with a state of N numbers: integrates phase by phase and calls record(t, y) at the times of a grid.
template <int N, class Record> class Recorder {
public:
  Recorder(std::vector<double> grid, Record record) : grid_(std::move(grid)), record_(std::move(record)) {}

  Number time = 0;
  State<N> state{};

  [[nodiscard]] Number end() const { return grid_.back(); }
  // Until stop(t, y) becomes negative (true: it did, and time and state are those of the event) or the last time of the grid (false).
  template <class Rhs, class Stop> bool advance(const Rhs &rhs, const Stop &stop, Number step = 0.01L) {
    while (next_ < grid_.size()) {
      if (gaussUntil<N>(rhs, stop, time, state, static_cast<Number>(grid_[next_]), step))
        return true;
      record_(time, state);
      ++next_;
    }
    return false;
  }

private:
  std::vector<double> grid_;
  Record record_;
  std::size_t next_ = 0;
};

}  // namespace tf::test
