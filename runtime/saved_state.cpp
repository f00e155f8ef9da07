#include "runtime/saved_state.h"

#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace tf::runtime {

namespace {

struct Header {
  std::uint64_t mark;
  std::uint64_t size;         // of everything
  std::uint64_t fingerprint;  // of model, parameters and what the run is differentiated by
  std::uint64_t checksum;     // of everything after the header
};

constexpr std::uint64_t hashStart = 0xcbf29ce484222325u;
constexpr std::uint64_t stateMark = 0x3153544154534654u;  // "TFSTATS1"

// FNV-1a.
std::uint64_t hashBytes(std::uint64_t hash, const void *data, std::size_t size) {
  const auto *bytes = static_cast<const unsigned char *>(data);
  for (std::size_t i = 0; i < size; ++i)
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

std::uint64_t fingerprint(const ModelInstance &instance, const Simulation &simulation) {
  const std::uint64_t ofModel = hashBytes(hashStart, instance.model().hash, std::strlen(instance.model().hash));
  const std::uint64_t hash = hashBytes(ofModel, instance.parameters().data(), instance.parameters().size_bytes());
  const std::vector<std::int32_t> variables = simulation.differentiatedBy();
  return hashBytes(hash, variables.data(), variables.size() * sizeof(std::int32_t));
}

std::size_t inputsSize(const InputSignals &inputs) { return static_cast<std::size_t>(inputs.count()) * sizeof(double); }

// The simulation writes and reads memory of the largest alignment.
std::vector<std::max_align_t> alignedMemory(std::size_t bytes) {
  return std::vector<std::max_align_t>((bytes + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t));
}

}  // namespace

std::size_t savedStateSize(const InputSignals &inputs, const Simulation &simulation) {
  return sizeof(Header) + inputsSize(inputs) + simulation.stateSize();
}

// Header, constants of inputs (NaN: not a constant), state of the simulation.
void saveState(const ModelInstance &instance, const InputSignals &inputs, const Simulation &simulation, void *buffer) {
  Header header{stateMark, savedStateSize(inputs, simulation), fingerprint(instance, simulation), 0};
  auto *const contents = static_cast<unsigned char *>(buffer) + sizeof header;
  auto *out = contents;
  for (std::int32_t i = 0; i < inputs.count(); ++i) {
    const double value = inputs.constant(i).value_or(std::numeric_limits<double>::quiet_NaN());
    std::memcpy(out, &value, sizeof value);
    out += sizeof value;
  }
  auto state = alignedMemory(simulation.stateSize());
  simulation.save(state.data());
  std::memcpy(out, state.data(), simulation.stateSize());
  header.checksum = hashBytes(hashStart, contents, header.size - sizeof header);
  std::memcpy(buffer, &header, sizeof header);
}

Outcome<void> restoreState(const ModelInstance &instance, InputSignals &inputs, Simulation &simulation, const void *buffer,
                           std::size_t size) {
  Header header{};
  const auto *in = static_cast<const unsigned char *>(buffer);
  if (in != nullptr && size >= sizeof header)
    std::memcpy(&header, in, sizeof header);
  if (header.mark != stateMark || header.size > size || header.size < sizeof header)
    return Failure{"this is not a saved state"};
  if (header.size != savedStateSize(inputs, simulation) || header.fingerprint != fingerprint(instance, simulation))
    return Failure{"the state is of another model, of other parameters or of a run with other sensitivities or energy balance"};
  in += sizeof header;
  if (header.checksum != hashBytes(hashStart, in, header.size - sizeof header))
    return Failure{"the saved state is damaged"};
  for (std::int32_t i = 0; i < inputs.count(); ++i) {
    double value = 0;
    std::memcpy(&value, in, sizeof value);
    in += sizeof value;
    if (value == value && inputs.constant(i) != value)
      inputs.setConstant(i, value);
  }
  auto state = alignedMemory(simulation.stateSize());
  std::memcpy(state.data(), in, simulation.stateSize());
  simulation.restore(state.data());
  return {};
}

}  // namespace tf::runtime
