// Trajectories of tests/accuracy/reference, computed elsewhere with errors below 1e-9.
#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/tolerances/references.h"

namespace tf::test {

namespace {

Reference recorded(const std::string &name, const std::vector<std::string> &columns, std::vector<std::string> variables) {
  const std::string path = TF_SOURCE_DIR "/tests/accuracy/reference/" + name;
  const CsvTable grid(path + ".csv"), events(path + "_events.csv");
  Reference reference{.variables = std::move(variables), .error = 1e-9};
  for (std::size_t row = 1; row < grid.rows(); ++row) {
    Sample &sample = reference.samples.emplace_back();
    sample.time = grid["t"][row];
    for (const std::string &column : columns)
      sample.values.push_back(grid[column][row]);
  }
  for (std::size_t row = 1; row < events.rows(); ++row)
    reference.addEvent(events["t"][row], TF_EVENT_COUNT);
  return reference;
}

}  // namespace

Reference chainReference() {
  return recorded("S15_chain3", {"x0", "y0", "th0", "th1", "th2", "vx0", "vy0", "w0", "w1", "w2"},
                  {"r[1]", "r[2]", "phi[1]", "phi[2]", "phi[3]", "der(r[1])", "der(r[2])", "der(phi[1])", "der(phi[2])", "der(phi[3])"});
}

Reference sliderCrankReference() {
  return recorded("S11_slidercrank_e0", {"th1", "th2", "th3", "w1", "w2", "w3"},
                  {"phi[1]", "phi[2]", "phi[3]", "der(phi[1])", "der(phi[2])", "der(phi[3])"});
}

}  // namespace tf::test
