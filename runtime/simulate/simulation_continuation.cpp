// Saved states: what a run goes on from, bit by bit as it would have.
#include "runtime/simulate/simulation_implementation.h"

#include <cstring>

namespace tf::runtime {

template <class Field> void Simulation::Implementation::forContinuation(Continuation &more, const Field &field) {
  const auto vector = [&field](auto &values) { field(values.data(), values.size() * sizeof values[0]); };
  field(&time_, sizeof time_);
  field(&suggestedStep_, sizeof suggestedStep_);
  field(&switchTime_, sizeof switchTime_);
  field(&jamTime_, sizeof jamTime_);
  field(&progress_, sizeof progress_);
  vector(selection_.grazingSpeeds());
  vector(more.energy);
  vector(more.impacts);
  vector(more.sensitivities);
  vector(more.inputs);
  field(&more.hasInputsToTake, sizeof more.hasInputsToTake);
  field(&more.hasFailed, sizeof more.hasFailed);
  field(&openTimeEvent_, sizeof openTimeEvent_);
  field(&areSensitivitiesLost_, sizeof areSensitivitiesLost_);
  field(&isShareLost_, sizeof isShareLost_);
  vector(state_);
  vector(impulse_);
  mode_.closed.resize(model_.nc);
  mode_.tangent.resize(model_.nt);
  mode_.switches.resize(model_.ns);
  mode_.direction.resize(model_.nt);
  mode_.held.resize(model_.ns);
  vector(mode_.closed);
  vector(mode_.tangent);
  vector(mode_.switches);
  vector(mode_.direction);
  vector(mode_.held);
}

// Room for what the parts of the simulation have.
Simulation::Implementation::Continuation Simulation::Implementation::continuation() const {
  Continuation more;
  more.energy.resize(energy_ ? 1 : 0);
  more.impacts.resize(rest_.numberCount());
  more.sensitivities.resize(sensitivities_ ? sensitivities_->numberCount() : 0);
  more.inputs.resize(model_.nu);
  return more;
}

std::size_t Simulation::Implementation::stateSize() {
  Continuation more = continuation();
  std::size_t size = 0;
  forContinuation(more, [&size](const void *, std::size_t bytes) { size += bytes; });
  return size;
}

void Simulation::Implementation::save(void *buffer) {
  Continuation more = continuation();
  if (energy_)
    more.energy.front() = energy_->totals();
  rest_.write(more.impacts.data());
  if (sensitivities_)
    sensitivities_->write(more.sensitivities.data());
  inputs_.evaluate(time_, at_.segment(), more.inputs.data(), nullptr);
  more.hasInputsToTake = inputs_.revision() != inputRevision_;
  more.hasFailed = !error_.empty();
  auto *out = static_cast<unsigned char *>(buffer);
  forContinuation(more, [&out](const void *data, std::size_t bytes) {
    if (bytes > 0)
      std::memcpy(out, data, bytes);
    out += bytes;
  });
  rest_.read(more.impacts.data());
  if (modeValid_)
    beginAnew();
}

// The saved point is where both continuations do.
void Simulation::Implementation::beginAnew() {
  at_.screen().forget();
  dynamics_.forget();
  integrators_.forget();
  lingeringSteps_ = 0;
  switchProgress_.start(model_.ns);
  redundancy_.forgetChoice();
  // Where it cannot start, inputs have become others or the run has failed: the mode is chosen anew before it goes on.
  if (!dynamics_.start(mode_, time_, state_.data(), rate_.data()))
    return;
  redundancy_.choose(state_.data());
  startMode();
}

void Simulation::Implementation::restore(const void *buffer) {
  Continuation more = continuation();
  const auto *in = static_cast<const unsigned char *>(buffer);
  forContinuation(more, [&in](void *data, std::size_t bytes) {
    if (bytes > 0)
      std::memcpy(data, in, bytes);
    in += bytes;
  });
  if (energy_)
    energy_->restore(more.energy.front());
  rest_.read(more.impacts.data());
  if (sensitivities_)
    sensitivities_->read(more.sensitivities.data());
  error_ = more.hasFailed ? "the restored state is that of a run that had failed" : "";
  enterSegment();
  // Inputs other than those that the mode was chosen with: they had been set before the state was saved, or tables are other ones here.
  std::vector<double> inputs(more.inputs.size());
  inputs_.evaluate(time_, at_.segment(), inputs.data(), nullptr);
  if (more.hasInputsToTake || inputs != more.inputs)
    inputRevision_ = noRevision;
  modeValid_ = true;
  beginAnew();
}

}  // namespace tf::runtime
