// `--emit pss | stewart | step`.
#include "compiler/filippov/form_printer.h"

#include "runtime/abi/tf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace tf::filippov {

namespace {

// Up to this many modes of f_ODE, each mode's right-hand side is written out.
constexpr std::size_t kWrittenOutModes = 8;

std::string signText(std::size_t k, int sign) { return fmt::format("c[{}] {} 0", k + 1, sign > 0 ? ">" : "<"); }

std::string setName(const FormPrinter &p, int contact) { return p.system.contacts.size() > 1 ? fmt::format("Q{}", contact + 1) : "Q"; }

std::size_t firstStep(const FormPrinter &p, int contact) {
  const auto &steps = p.form.steps;
  return static_cast<std::size_t>(
      std::ranges::find_if(steps, [&](const StepFunction &step) { return step.role == StepRole::Gap && step.owner == contact; }) -
      steps.begin());
}

std::string contactSets(const FormPrinter &p) {
  std::string all;
  for (int k = 0; k < static_cast<int>(p.system.contacts.size()); ++k) {
    const std::size_t gap = firstStep(p, k);
    all += fmt::format("  {} = {{y | {}, {}}}\n", setName(p, k), signText(gap, -1), signText(gap + 1, -1));
  }
  return all;
}

// Conditions on the steps inside f_ODE that tell modes with the same contacts apart: those that all regions of the mode share.
std::vector<std::size_t> commonSteps(const std::vector<const Region *> &regions, std::size_t steps) {
  std::vector<std::size_t> common;
  for (std::size_t k = 0; k < steps; ++k)
    if (std::ranges::all_of(regions, [&](const Region *region) { return region->signs[k] == regions[0]->signs[k]; }))
      common.push_back(k);
  return common;
}

std::string regionSet(const FormPrinter &p, const std::vector<const Region *> &regions) {
  std::string sets, signs;
  const Region &first = *regions[0];
  for (int contact = 0; contact < static_cast<int>(p.system.contacts.size()); ++contact) {
    const auto isPushing = [&](int field) { return p.form.fields[static_cast<std::size_t>(field)].contact == contact; };
    const bool isIn = std::ranges::any_of(first.active, isPushing);
    sets += (sets.empty() ? "" : " ∩ ") + std::string(isIn ? "" : "not ") + setName(p, contact);
  }
  for (const std::size_t k : commonSteps(regions, p.form.steps.size()))
    if (p.form.steps[k].role > StepRole::GapRate)
      signs += (signs.empty() ? "" : ", ") + signText(k, first.signs[k]);
  if (signs.empty())
    return sets.empty() ? "all y" : sets;
  return sets + (sets.empty() ? "" : " ∩ ") + fmt::format("{{y | {}}}", signs);
}

std::vector<std::vector<const Region *>> byMode(const std::vector<Region> &regions) {
  std::vector<std::vector<const Region *>> modes;
  for (const Region &region : regions) {
    if (region.mode >= static_cast<int>(modes.size()))
      modes.emplace_back();
    modes[static_cast<std::size_t>(region.mode)].push_back(&region);
  }
  return modes;
}

// One region of each mode in which time runs; empty if there are too many to write f_ODE out for each.
std::vector<const Region *> odeRegions(const std::vector<Region> &regions) {
  std::vector<const Region *> chosen;
  for (const auto &mode : byMode(regions))
    if (mode[0]->active[0] == 0)
      chosen.push_back(mode[0]);
  return chosen.size() > kWrittenOutModes ? std::vector<const Region *>{} : chosen;
}

std::string enumeratedModes(const FormPrinter &p) {
  const std::vector<Region> all = regions(p.form, p.system);
  const auto modes = byMode(all);
  const bool isSingle = p.system.contacts.size() == 1 && !p.hasInnerSteps();
  std::string text = "\nregions\n" + contactSets(p);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (isSingle && m == 0)
      text += "  R1 = R1a ∪ R1b,  R1a = {y | c[1] > 0},  R1b = {y | c[1] < 0, c[2] > 0}\n";
    else
      text += fmt::format("  R{} = {}\n", m + 1, regionSet(p, modes[m]));
  }
  text += "\nmodes\n";
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Region &region = *modes[m][0];
    const bool timeRuns = region.active[0] == 0;
    text += fmt::format("  y' = f_{}(y{}) in R{}:  f_{} = {}{}\n", m + 1, timeRuns ? ", u" : "", m + 1, m + 1, p.sum(region),
                        timeRuns ? "" : "  (time is frozen)");
  }
  return text + p.fields(odeRegions(all));
}

std::string perContactModes(const FormPrinter &p) {
  std::string text = fmt::format("\nregions (more than {} switching functions: per contact instead of all combinations)\n{}",
                                 kEnumerationLimit, contactSets(p));
  text += "\nmodes\n  outside of all Q: y' = f_ODE(y, u)\n  elsewhere the fields of all contacts with y in Q add up:\n";
  for (const Field &field : p.form.fields) {
    if (field.contact < 0)
      continue;
    const std::string side =
        field.side == 0 ? ""
                        : fmt::format(" ∩ {{y | {}}}", signText(firstStep(p, field.contact) + 2 + static_cast<std::size_t>(field.direction),
                                                                field.side < 0 ? 1 : -1));
    text += fmt::format("  {} in {}{}\n", field.name, setName(p, field.contact), side);
  }
  return text + p.fields({});
}

// Rows first, …, first + count − 1 of the sign matrix over `columns` with the mode of each.
std::string signMatrix(const std::vector<std::vector<int>> &rows, const std::vector<std::string> &labels) {
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::string row;
    for (const int sign : rows[r])
      row += fmt::format("{:>3}", sign);
    text += fmt::format("  [{} ]  {}\n", row, labels[r]);
  }
  return text;
}

std::string enumeratedStewart(const FormPrinter &p) {
  const std::vector<Region> all = regions(p.form, p.system);
  std::vector<std::vector<int>> rows;
  std::vector<std::string> labels;
  std::string g;
  std::map<int, std::string> sums;
  for (std::size_t r = 0; r < all.size(); ++r) {
    rows.push_back(all[r].signs);
    labels.push_back(fmt::format("R{}", all[r].mode + 1));
    std::string row;
    for (std::size_t k = 0; k < all[r].signs.size(); ++k)
      row += fmt::format("{}c[{}]", all[r].signs[k] > 0 ? (row.empty() ? "-" : " - ") : (row.empty() ? "" : " + "), k + 1);
    g += fmt::format("  g[{}] = {}\n", r + 1, row);
    std::string &sum = sums[all[r].mode];
    sum += fmt::format("{}theta[{}]", sum.empty() ? "" : " + ", r + 1);
  }
  std::string text = "\nsign matrix S (one row per region)\n" + signMatrix(rows, labels);
  text += "\ng = -S c\n" + g + "\nright-hand side\n";
  const auto modes = byMode(all);
  std::string rhs;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Region &region = *modes[m][0];
    std::string field = p.sum(region);
    if (field.find(' ') != std::string::npos)
      field = "(" + field + ")";
    const std::string &sum = sums[static_cast<int>(m)];
    rhs += fmt::format("{}{} {}\n", m == 0 ? "  y' = " : "     + ", modes[m].size() > 1 ? "(" + sum + ")" : sum, field);
  }
  return text + rhs + "  theta minimises g*theta subject to theta >= 0, sum(theta) = 1\n" + p.fields(odeRegions(all));
}

// Over c1, c2 and, where it has a slip, one of the contact's c3.
std::string contactMatrix(const FormPrinter &p, int contact, int direction) {
  const Contact &of = p.system.contacts[static_cast<std::size_t>(contact)];
  const std::size_t first = firstStep(p, contact), count = of.tangentCount > 0 ? 3 : 2;
  std::vector<std::vector<int>> rows;
  std::vector<std::string> labels;
  for (std::size_t row = 0; row < std::size_t{1} << count; ++row) {
    std::vector<int> signs;
    signs.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
      signs.push_back((row >> (count - 1 - k)) % 2 == 0 ? 1 : -1);
    const bool isPushing = signs[0] < 0 && signs[1] < 0;
    Region region;
    for (std::size_t f = 1; f < p.form.fields.size(); ++f) {
      const Field &field = p.form.fields[f];
      if (isPushing && field.contact == contact && (field.side == 0 || (field.direction == direction && signs[2] * field.side < 0)))
        region.active.push_back(static_cast<int>(f));
    }
    rows.push_back(std::move(signs));
    labels.push_back(isPushing ? p.sum(region) : "f_ODE unless another contact pushes");
  }
  const std::string last = count == 3 ? fmt::format(", c[{}]", first + 3 + static_cast<std::size_t>(direction)) : "";
  return fmt::format("  {}: columns c[{}], c[{}]{}\n", of.name, first + 1, first + 2, last) + signMatrix(rows, labels);
}

std::string perContactStewart(const FormPrinter &p) {
  std::string text =
      fmt::format("\nsign matrices (more than {} switching functions: one per contact instead of one for all)\n", kEnumerationLimit);
  for (int contact = 0; contact < static_cast<int>(p.system.contacts.size()); ++contact) {
    const Contact &of = p.system.contacts[static_cast<std::size_t>(contact)];
    const int directions = of.frictionForm == TF_FRICTION_POLYHEDRAL ? of.tangentCount : 1;
    for (int direction = 0; direction < directions; ++direction)
      text += contactMatrix(p, contact, direction);
  }
  return text + "\ng = -S c for each contact; the fields of all contacts that push add up\n" + p.fields({});
}

}  // namespace

std::string printPiecewise(const FilippovSystem &filippov, HybridSystem &system) {
  const FormPrinter p(filippov, system);
  return p.heading("Piecewise smooth system") + p.switchingFunctions() + (p.isEnumerable() ? enumeratedModes(p) : perContactModes(p));
}

std::string printStewart(const FilippovSystem &filippov, HybridSystem &system) {
  const FormPrinter p(filippov, system);
  return p.heading("Stewart's form") + p.switchingFunctions() + (p.isEnumerable() ? enumeratedStewart(p) : perContactStewart(p));
}

std::string printStep(const FilippovSystem &filippov, HybridSystem &system) {
  const FormPrinter p(filippov, system);
  std::string text = p.heading("Step form") + p.switchingFunctions() + "\nstep variables\n";
  for (std::size_t k = 0; k < filippov.steps.size(); ++k)
    text += fmt::format("  alpha[{}] in gamma(c[{}])\n", k + 1, k + 1);
  text += "\nmultipliers\n";
  std::string sum;
  for (std::size_t k = 0; k < filippov.terms.size(); ++k) {
    text += fmt::format("  theta[{}] = {}\n", k + 1, p.text(filippov.terms[k].coefficient));
    const std::string &name = filippov.fields[static_cast<std::size_t>(filippov.terms[k].field)].name;
    sum +=
        fmt::format("{}theta[{}]*{}", k == 0 ? "" : " + ", k + 1, name.find_first_of(" -") == std::string::npos ? name : "(" + name + ")");
  }
  return text + "\nright-hand side\n  y' = " + sum + "\n" + p.fields({});
}

}  // namespace tf::filippov
