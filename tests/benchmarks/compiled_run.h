// A model compiled by tfc, simulated again and again through libtf in this process.
#pragma once

#include "runtime/tf.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tf::bench {

class CompiledRun {
public:
  using Settings = std::vector<std::pair<const char *, double>>;

  // Throws std::runtime_error with the library's message, here and below.
  CompiledRun(const std::string &library, std::string name, const Settings &settings, double end);

  // Initialises and advances to the end.
  void simulate(double tolerance);
  // After simulate().
  [[nodiscard]] double value(const char *variable) const;
  // Simulates and tells when the first contact came to rest; NaN where none did.
  [[nodiscard]] double timeOfRest(double tolerance);

private:
  struct Free {
    void operator()(tf_simulation *simulation) const { tf_free(simulation); }
  };

  void check(tf_status status) const;

  std::string name_;
  double end_;
  std::unique_ptr<tf_simulation, Free> simulation_;
};

}  // namespace tf::bench
