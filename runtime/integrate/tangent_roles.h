// What the tangential rows of a model do: all but those of relaxed friction (tf_model.h) take part in impacts and while time runs.
#pragma once

#include "runtime/abi/tf_model.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

enum class TangentRole : std::uint8_t {
  Always,
  Frozen,  // component of a relaxed slip: takes part in impacts only
  Steady,  // of a relaxed slip while time runs: slips forwards, whatever its slip is
  Edge,    // of a relaxed slip while time runs: its slip is zero on the edge of the disk
};

[[nodiscard]] inline bool takesPartInImpacts(TangentRole role) { return role == TangentRole::Always || role == TangentRole::Frozen; }
[[nodiscard]] inline bool takesPartInMotion(TangentRole role) { return role != TangentRole::Frozen; }

// nt.
[[nodiscard]] std::vector<TangentRole> rolesOfTangents(const tf_model &model);

// Contact of a tangential row of the model, −1 for a row of a friction element.
[[nodiscard]] std::vector<int> contactsOfTangents(const tf_model &model);

// Tangential row of the model that the slip with two components begins with which `row` is a component of; −1 for all other rows.
[[nodiscard]] std::vector<int> pairsOfTangents(const tf_model &model);

// visit(row) for the tangential rows of some contacts (ascending numbers) and of all friction elements, ascending.
template <class Visit> void forEachTangent(const tf_model &model, const std::vector<int> &contacts, Visit visit) {
  const auto visitRows = [&visit](const auto &element) {
    for (int k = 0; k < element.tangent_count; ++k)
      visit(element.tangent_first + k);
  };
  for (const int i : contacts)
    visitRows(model.contacts[i]);
  for (int i = 0; i < model.nf; ++i)
    visitRows(model.frictions[i]);
}

// The first two tangential rows of a contact or friction element are the components of one slip, with one disk of friction forces.
template <class Element> [[nodiscard]] bool sharesDisk(const Element &element) {
  return element.friction_form == TF_FRICTION_RELAXED || (element.friction_form == TF_FRICTION_EXACT && element.tangent_count == 2);
}

// A contact or friction element has relaxed friction.
[[nodiscard]] bool hasRelaxedSlips(const tf_model &model);

// Power of the friction of a relaxed slip on it, from the forces and the slips of its steady and its edge row, at place 0 and 1.
[[nodiscard]] double relaxedFrictionPower(const double *forces, const double *slips);

// ‖slip‖ at the edge of the disk of a relaxed slip, from the slips of these two rows.
[[nodiscard]] double relaxedSlipRadius(const double *slips);

}  // namespace tf::runtime
