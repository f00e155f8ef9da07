#include "runtime/model/input_signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Outcome<void> checkPoints(std::span<const double> times, std::span<const double> values) {
  if (times.empty() || times.size() != values.size())
    return Failure{"an input table needs at least one point, and as many values as times"};
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || !std::isfinite(values[i]))
      return Failure{fmt::format("point {} of the input table is not finite", i + 1)};
    if (i > 0 && times[i] < times[i - 1])
      return Failure{
          fmt::format("the times of an input table must not decrease: point {} is at {}, after {}", i + 1, times[i], times[i - 1])};
  }
  return {};
}

}  // namespace

InputSignals::InputSignals(std::int32_t count)
    : defaults_(static_cast<std::size_t>(count)), constants_(static_cast<std::size_t>(count)), given_(static_cast<std::size_t>(count)),
      varying_(static_cast<std::size_t>(count)) {}

void InputSignals::setDefaults(std::span<const double> values) {
  std::copy(values.begin(), values.end(), defaults_.begin());
  for (std::size_t i = 0; i < defaults_.size(); ++i)
    if (given_[i] == 0)
      constants_[i] = defaults_[i];
  ++revision_;
}

void InputSignals::remove(std::int32_t input) {
  const auto ofInput = [input](const auto &signal) { return signal.input == input; };
  std::erase_if(tables_, ofInput);
  std::erase_if(functions_, ofInput);
  given_[static_cast<std::size_t>(input)] = 1;
  varying_[static_cast<std::size_t>(input)] = 0;
  ++revision_;
}

void InputSignals::setConstant(std::int32_t input, double value) {
  if (isGiven(input) && constant(input) == value)
    return;
  remove(input);
  constants_[static_cast<std::size_t>(input)] = value;
}

// Pieces of zero length and constant pieces that go on as the one before are left out: they would be breakpoints for nothing.
Outcome<void> InputSignals::setTable(std::int32_t input, std::span<const double> times, std::span<const double> values,
                                     Interpolation interpolation) {
  if (auto checked = checkPoints(times, values); !checked)
    return checked;
  remove(input);
  Table table{input, {{-infinity, values.front(), 0}}};
  double end = values.front();  // of the last piece
  const auto append = [&](double begin, double value, double slope, double nextEnd) {
    const Piece &last = table.pieces.back();
    if (value != end || slope != 0 || last.slope != 0)
      table.pieces.push_back({begin, value, slope});
    end = nextEnd;
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i + 1 == times.size()) {
      append(times[i], values[i], 0, values[i]);
    } else if (times[i + 1] > times[i]) {
      const bool linear = interpolation == Interpolation::Linear;
      append(times[i], values[i], linear ? (values[i + 1] - values[i]) / (times[i + 1] - times[i]) : 0, linear ? values[i + 1] : values[i]);
    }
  }
  tables_.push_back(std::move(table));
  varying_[static_cast<std::size_t>(input)] = 1;
  return {};
}

void InputSignals::setFunction(std::int32_t input, InputFunction function) {
  remove(input);
  functions_.push_back({input, std::move(function)});
  varying_[static_cast<std::size_t>(input)] = 1;
}

bool InputSignals::isGiven(std::int32_t input) const { return given_[static_cast<std::size_t>(input)] != 0; }

std::optional<double> InputSignals::constant(std::int32_t input) const {
  const auto i = static_cast<std::size_t>(input);
  return varying_[i] != 0 ? std::nullopt : std::optional(constants_[i]);
}

// Successive look-ups are near one another: the remembered piece, its neighbours, then all.
const InputSignals::Piece &InputSignals::Table::at(double segment) const {
  const auto holds = [&](std::size_t i) { return pieces[i].begin <= segment && (i + 1 == pieces.size() || segment < pieces[i + 1].begin); };
  if (holds(place))
    return pieces[place];
  if (place + 1 < pieces.size() && holds(place + 1))
    return pieces[++place];
  const auto next =
      std::upper_bound(pieces.begin() + 1, pieces.end(), segment, [](double time, const Piece &piece) { return time < piece.begin; });
  place = static_cast<std::size_t>(next - pieces.begin()) - 1;
  return pieces[place];
}

// Five-point central difference of the piece's continuation; where that does not exist (a root that ends at the breakpoint), of points
// towards `segment`.
double InputSignals::Function::rate(double time, double segment) const {
  if (function.rate)
    return function.rate(time, segment);
  const double wanted = std::max(1e-4, 1e-6 * std::abs(time));  // truncation (omega h)^4/30, rounding 1e-16/h
  const double h = (time + wanted) - time;                      // representable
  const auto value = [&](double step) { return function.value(time + step, segment); };
  const double central = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
  if (std::isfinite(central))
    return central;
  const double reach = segment == time ? h : std::clamp((segment - time) / 4, -h, h);
  const double s = (time + reach) - time;
  return (-25 * value(0) + 48 * value(s) - 36 * value(2 * s) + 16 * value(3 * s) - 3 * value(4 * s)) / (12 * s);
}

void InputSignals::evaluate(double time, double segment, double *u, double *uRate) const {
  std::copy(constants_.begin(), constants_.end(), u);
  if (uRate != nullptr)
    std::fill_n(uRate, constants_.size(), 0.0);
  for (const Table &table : tables_) {
    const Piece &piece = table.at(segment);
    // The slope of the outer pieces is 0 and their begin may be infinite.
    u[table.input] = piece.slope == 0 ? piece.value : piece.value + piece.slope * (time - piece.begin);
    if (uRate != nullptr)
      uRate[table.input] = piece.slope;
  }
  for (const Function &function : functions_) {
    u[function.input] = function.function.value(time, segment);
    if (uRate != nullptr)
      uRate[function.input] = function.rate(time, segment);
  }
}

double InputSignals::nextBreakpoint(double time) const {
  double next = infinity;
  for (const Table &table : tables_) {
    const std::size_t place = static_cast<std::size_t>(&table.at(time) - table.pieces.data());
    if (place + 1 < table.pieces.size())
      next = std::min(next, table.pieces[place + 1].begin);
  }
  for (const Function &function : functions_)
    if (function.function.nextBreakpoint)
      next = std::min(next, function.function.nextBreakpoint(time));
  return next;
}

bool InputSignals::isConstant(double segment) const {
  return functions_.empty() &&
         std::all_of(tables_.begin(), tables_.end(), [&](const Table &table) { return table.at(segment).slope == 0; });
}

}  // namespace tf::runtime
