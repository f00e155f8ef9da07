#include "lang/semantics/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace tf::semantics {

namespace {

struct Symbol {
  std::string_view text;
  Unit unit;
  bool takesPrefix = true;
};

constexpr double kPi = 3.14159265358979323846;

constexpr Unit make(double m, double kg, double s, double A = 0, double K = 0, double mol = 0, double cd = 0, double scale = 1,
                    double offset = 0) {
  return {{m, kg, s, A, K, mol, cd}, scale, offset};
}

constexpr std::array kSymbols = {
    Symbol{"m", make(1, 0, 0), true},
    Symbol{"g", make(0, 1, 0, 0, 0, 0, 0, 1e-3), true},
    Symbol{"s", make(0, 0, 1), true},
    Symbol{"A", make(0, 0, 0, 1), true},
    Symbol{"K", make(0, 0, 0, 0, 1), true},
    Symbol{"mol", make(0, 0, 0, 0, 0, 1), true},
    Symbol{"cd", make(0, 0, 0, 0, 0, 0, 1), true},
    Symbol{"rad", make(0, 0, 0), true},
    Symbol{"sr", make(0, 0, 0), true},
    Symbol{"Hz", make(0, 0, -1), true},
    Symbol{"N", make(1, 1, -2), true},
    Symbol{"Pa", make(-1, 1, -2), true},
    Symbol{"J", make(2, 1, -2), true},
    Symbol{"W", make(2, 1, -3), true},
    Symbol{"C", make(0, 0, 1, 1), true},
    Symbol{"V", make(2, 1, -3, -1), true},
    Symbol{"F", make(-2, -1, 4, 2), true},
    Symbol{"Ohm", make(2, 1, -3, -2), true},
    Symbol{"S", make(-2, -1, 3, 2), true},
    Symbol{"Wb", make(2, 1, -2, -1), true},
    Symbol{"T", make(0, 1, -2, -1), true},
    Symbol{"H", make(2, 1, -2, -2), true},
    Symbol{"lm", make(0, 0, 0, 0, 0, 0, 1), true},
    Symbol{"lx", make(-2, 0, 0, 0, 0, 0, 1), true},
    Symbol{"bar", make(-1, 1, -2, 0, 0, 0, 0, 1e5), true},
    Symbol{"l", make(3, 0, 0, 0, 0, 0, 0, 1e-3), true},
    Symbol{"L", make(3, 0, 0, 0, 0, 0, 0, 1e-3), true},
    Symbol{"t", make(0, 1, 0, 0, 0, 0, 0, 1e3), true},
    Symbol{"eV", make(2, 1, -2, 0, 0, 0, 0, 1.602176634e-19), true},
    Symbol{"min", make(0, 0, 1, 0, 0, 0, 0, 60), false},
    Symbol{"h", make(0, 0, 1, 0, 0, 0, 0, 3600), false},
    Symbol{"d", make(0, 0, 1, 0, 0, 0, 0, 86400), false},
    Symbol{"deg", make(0, 0, 0, 0, 0, 0, 0, kPi / 180), false},
    Symbol{"rev", make(0, 0, 0, 0, 0, 0, 0, 2 * kPi), false},
    Symbol{"rpm", make(0, 0, -1, 0, 0, 0, 0, kPi / 30), false},
    Symbol{"degC", make(0, 0, 0, 0, 1, 0, 0, 1, 273.15), false},
    Symbol{"%", make(0, 0, 0, 0, 0, 0, 0, 1e-2), false},
};

constexpr std::array<std::pair<std::string_view, double>, 20> kPrefixes = {
    {{"da", 1e1}, {"Y", 1e24},  {"Z", 1e21},  {"E", 1e18},  {"P", 1e15},  {"T", 1e12}, {"G", 1e9},
     {"M", 1e6},  {"k", 1e3},   {"h", 1e2},   {"d", 1e-1},  {"c", 1e-2},  {"m", 1e-3}, {"u", 1e-6},
     {"n", 1e-9}, {"p", 1e-12}, {"f", 1e-15}, {"a", 1e-18}, {"z", 1e-21}, {"y", 1e-24}}};

std::optional<Unit> findSymbol(std::string_view text) {
  for (const Symbol &symbol : kSymbols)
    if (symbol.text == text)
      return symbol.unit;
  for (const auto &[prefix, factor] : kPrefixes) {
    if (!text.starts_with(prefix))
      continue;
    const auto symbol = std::ranges::find(kSymbols, text.substr(prefix.size()), &Symbol::text);
    if (symbol == kSymbols.end() || !symbol->takesPrefix)
      continue;
    Unit unit = symbol->unit;
    unit.scale *= factor;
    return unit;
  }
  return std::nullopt;
}

// expression = factors ["/" denominator]; denominator = factor | "(" factors ")"; factors = factor {"." factor};
// factor = symbol [["+" | "-"] digits] | "1" | "(" expression ")"
class UnitParser {
public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  std::optional<Unit> parse() {
    const std::optional<Unit> unit = expression(0);
    return at_ == text_.size() ? unit : std::nullopt;
  }

private:
  bool accept(char c) {
    if (at_ >= text_.size() || text_[at_] != c)
      return false;
    ++at_;
    return true;
  }

  std::optional<Unit> expression(int depth) {
    std::optional<Unit> unit = factors(depth);
    if (unit && accept('/')) {
      const std::optional<Unit> denominator = factor(depth);
      unit = denominator ? std::optional(divide(*unit, *denominator)) : std::nullopt;
    }
    return unit;
  }

  std::optional<Unit> factors(int depth) {
    std::optional<Unit> unit = factor(depth);
    while (unit && accept('.')) {
      const std::optional<Unit> next = factor(depth);
      unit = next ? std::optional(multiply(*unit, *next)) : std::nullopt;
    }
    return unit;
  }

  std::optional<Unit> factor(int depth) {
    if (depth > 20)
      return std::nullopt;
    if (accept('(')) {
      const std::optional<Unit> inner = expression(depth + 1);
      return accept(')') ? inner : std::nullopt;
    }
    if (accept('1'))
      return Unit{};
    const std::size_t begin = at_;
    while (at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '%'))
      ++at_;
    const std::optional<Unit> symbol = findSymbol(text_.substr(begin, at_ - begin));
    return symbol ? std::optional(power(*symbol, exponent())) : std::nullopt;
  }

  double exponent() {
    const std::size_t begin = at_;
    const bool isNegative = accept('-');
    if (!isNegative)
      accept('+');
    double value = 0;
    bool hasDigits = false;
    while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) != 0 && value < 100) {
      value = value * 10 + (text_[at_++] - '0');
      hasDigits = true;
    }
    if (!hasDigits) {
      at_ = begin;
      return 1;
    }
    return isNegative ? -value : value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::string factorText(std::string_view symbol, double exponent) {
  return exponent == 1 ? std::string(symbol) : fmt::format("{}{}", symbol, exponent);
}

}  // namespace

bool Unit::isSame(const Unit &other) const {
  for (std::size_t i = 0; i < exponents.size(); ++i)
    if (std::abs(exponents[i] - other.exponents[i]) > 1e-9)
      return false;
  return std::abs(scale - other.scale) <= 1e-9 * std::abs(scale) && offset == other.offset;
}

Unit multiply(const Unit &a, const Unit &b) {
  Unit result;
  for (std::size_t i = 0; i < result.exponents.size(); ++i)
    result.exponents[i] = a.exponents[i] + b.exponents[i];
  result.scale = a.scale * b.scale;
  return result;
}

Unit divide(const Unit &a, const Unit &b) { return multiply(a, power(b, -1)); }

Unit power(const Unit &a, double exponent) {
  if (exponent == 1)
    return a;
  Unit result;
  for (std::size_t i = 0; i < result.exponents.size(); ++i)
    result.exponents[i] = a.exponents[i] * exponent;
  result.scale = std::pow(a.scale, exponent);
  return result;
}

std::optional<Unit> parseUnit(std::string_view text) { return UnitParser(text).parse(); }

std::string toString(const Unit &unit) {
  static constexpr std::array<std::string_view, 7> kBase = {"m", "kg", "s", "A", "K", "mol", "cd"};
  static constexpr std::array<std::size_t, 7> kOrder = {1, 0, 2, 3, 4, 5, 6};
  std::string numerator, denominator;
  int below = 0;
  for (const std::size_t i : kOrder) {
    const double exponent = unit.exponents[i];
    if (exponent == 0)
      continue;
    std::string &target = exponent > 0 ? numerator : denominator;
    target += (target.empty() ? "" : ".") + factorText(kBase[i], std::abs(exponent));
    below += exponent < 0 ? 1 : 0;
  }
  std::string text = numerator.empty() ? "1" : numerator;
  if (below > 0)
    text += below == 1 ? "/" + denominator : "/(" + denominator + ")";
  return unit.scale == 1 ? text : fmt::format("{}*{}", unit.scale, text);
}

}  // namespace tf::semantics
