// The inputs u(t): constants, tables and callbacks, smooth between breakpoints.
#pragma once

#include "runtime/model/outcome.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace tf::runtime {

enum class Interpolation : std::uint8_t { ZeroOrderHold, Linear };

// An input given by functions. All functions take physical times; `segment` is a time strictly inside the smooth piece whose (continued)
// values are meant.
struct InputFunction {
  std::function<double(double time, double segment)> value;
  std::function<double(double time, double segment)>
      rate;  // du/dt; empty: by differences of `value` (relative error 1e-10 where u changes over seconds)
  std::function<double(double time)> nextBreakpoint;  // the first one after time, infinity if there is none; empty: none
};

class InputSignals {
public:
  // All inputs start as the constant 0.
  explicit InputSignals(std::int32_t count = 0);

  // Values of the inputs that were not given otherwise: nu starts of the model.
  void setDefaults(std::span<const double> values);
  // The same constant again is no change.
  void setConstant(std::int32_t input, double value);
  // Points with nondecreasing, finite times and finite values, at least one. Before the first: its value; after the last: its value. Equal
  // times are a jump (of more than two points the outer ones count); at a breakpoint itself the segment decides.
  Outcome<void> setTable(std::int32_t input, std::span<const double> times, std::span<const double> values, Interpolation interpolation);
  void setFunction(std::int32_t input, InputFunction function);

  [[nodiscard]] std::int32_t count() const { return static_cast<std::int32_t>(defaults_.size()); }
  [[nodiscard]] bool isGiven(std::int32_t input) const;
  // The value of an input that is constant for all times, given or not; nothing for tables and functions.
  [[nodiscard]] std::optional<double> constant(std::int32_t input) const;

  // u [nu] and, unless null, du/dt [nu] at `time` of the smooth piece that `segment` lies strictly inside: at a breakpoint the limit from
  // that side. No allocation.
  void evaluate(double time, double segment, double *u, double *uRate) const;
  // The first breakpoint strictly after `time` over all inputs, infinity if there is none. Points of a table where nothing changes are
  // none.
  [[nodiscard]] double nextBreakpoint(double time) const;
  // No input changes within the piece of `segment`.
  [[nodiscard]] bool isConstant(double segment) const;
  // Counts changes by the setters: a run that goes on afterwards has to evaluate its inputs anew (a jump).
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

private:
  // value + slope * (time - begin) from `begin` to the next piece.
  struct Piece {
    double begin, value, slope;
  };
  struct Table {
    std::int32_t input;
    std::vector<Piece> pieces;      // the first begins at -infinity
    mutable std::size_t place = 0;  // of the last look-up
    [[nodiscard]] const Piece &at(double segment) const;
  };
  struct Function {
    std::int32_t input;
    InputFunction function;
    [[nodiscard]] double rate(double time, double segment) const;
  };

  void remove(std::int32_t input);

  std::vector<double> defaults_, constants_;  // nu; constants_ is what evaluate copies
  std::vector<std::uint8_t> given_, varying_;
  std::vector<Table> tables_;
  std::vector<Function> functions_;
  std::uint64_t revision_ = 0;
};

}  // namespace tf::runtime
