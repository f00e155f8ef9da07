#include "runtime/integrate/tangent_roles.h"

#include <algorithm>

namespace tf::runtime {

std::vector<TangentRole> rolesOfTangents(const tf_model &model) {
  std::vector<TangentRole> roles(model.nt, TangentRole::Always);
  const auto mark = [&roles](const auto &element) {
    if (element.friction_form != TF_FRICTION_RELAXED)
      return;
    std::fill_n(roles.begin() + element.tangent_first, TF_RELAXED_ROWS, TangentRole::Frozen);
    roles[element.tangent_first + TF_RELAXED_STEADY_ROW] = TangentRole::Steady;
    roles[element.tangent_first + TF_RELAXED_EDGE_ROW] = TangentRole::Edge;
  };
  std::for_each_n(model.contacts, model.nc, mark);
  std::for_each_n(model.frictions, model.nf, mark);
  return roles;
}

std::vector<int> contactsOfTangents(const tf_model &model) {
  std::vector<int> owner(model.nt, -1);
  for (int i = 0; i < model.nc; ++i)
    for (int k = 0; k < model.contacts[i].tangent_count; ++k)
      owner[model.contacts[i].tangent_first + k] = i;
  return owner;
}

std::vector<int> pairsOfTangents(const tf_model &model) {
  std::vector<int> pair(model.nt, -1);
  const auto mark = [&pair](const auto &element) {
    for (int k = 0; sharesDisk(element) && k < 2; ++k)
      pair[element.tangent_first + k] = element.tangent_first;
  };
  std::for_each_n(model.contacts, model.nc, mark);
  std::for_each_n(model.frictions, model.nf, mark);
  return pair;
}

// The gradient of s by the slip times the slip: s + ε_t outside, 2 s + ε_t inside. Rows are g_A (s + ε_t) and g_B s.
double relaxedFrictionPower(const double *forces, const double *slips) {
  const double steady = slips[0] / TF_RELAXED_STEADY, edge = slips[1] / TF_RELAXED_EDGE;
  return (TF_RELAXED_STEADY * forces[0] + TF_RELAXED_EDGE * forces[1]) * (steady + std::min(edge, 0.0));
}

bool hasRelaxedSlips(const tf_model &model) {
  const auto isRelaxed = [](const auto &element) { return element.friction_form == TF_FRICTION_RELAXED; };
  return std::any_of(model.contacts, model.contacts + model.nc, isRelaxed) ||
         std::any_of(model.frictions, model.frictions + model.nf, isRelaxed);
}

double relaxedSlipRadius(const double *slips) { return slips[0] / TF_RELAXED_STEADY - slips[1] / TF_RELAXED_EDGE; }

}  // namespace tf::runtime
