// What the printers of the piecewise smooth, Stewart and step forms share: names, switching functions, vector fields.
#pragma once

#include "compiler/filippov/filippov_system.h"

#include <string>

namespace tf::filippov {

class FormPrinter {
public:
  FormPrinter(const FilippovSystem &filippov, HybridSystem &of) : form(filippov), system(of) {}

  // "Piecewise smooth system of Particle, y = (q[1], …, time)" and notes on what the form leaves out.
  [[nodiscard]] std::string heading(const char *title) const;
  // "  c[1] = q[2]    gap of floor" for each switching function.
  [[nodiscard]] std::string switchingFunctions() const;
  // Right-hand sides of f_ODE, of f_aux,n and f_aux,t of each contact, and M where it is not diagonal. `odeRegions`: one region of each
  // mode that f_ODE has, with the mode's own right-hand side; empty: f_ODE in terms of step variables.
  [[nodiscard]] std::string fields(const std::vector<const Region *> &odeRegions) const;
  [[nodiscard]] std::string text(ir::NodeId node) const;
  [[nodiscard]] bool isEnumerable() const { return form.steps.size() <= static_cast<std::size_t>(kEnumerationLimit); }
  // Name of what the fields of a region of one mode add up to: "f_ODE", or "f_ODE[R2]" where switches act inside f_ODE.
  [[nodiscard]] std::string sum(const Region &region) const;
  [[nodiscard]] bool hasInnerSteps() const;

  const FilippovSystem &form;
  HybridSystem &system;

private:
  // One field's components that are not 0, each on a line; step variables replaced by the signs of `region` if there is one.
  [[nodiscard]] std::string components(const std::string &name, const std::vector<ir::NodeId> &force,
                                       const std::vector<ir::NodeId> &stateDerivatives, bool timeRuns, const Region *region) const;
  [[nodiscard]] bool isMassDiagonal() const;
  [[nodiscard]] std::string symbolName(ir::Symbol symbol) const;
  [[nodiscard]] std::string auxiliary(int contact) const;
  [[nodiscard]] std::string massText() const;
  [[nodiscard]] std::string constraintText() const;
};

}  // namespace tf::filippov
