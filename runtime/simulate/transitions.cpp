#include "runtime/simulate/transitions.h"

#include "runtime/tf.h"

#include <algorithm>

namespace tf::runtime {

namespace {

template <class Element> bool hasTangent(const Element &element, int row) {
  return row >= element.tangent_first && row < element.tangent_first + element.tangent_count;
}

// The directions of a polyhedral form change one by one: the contact sticks where all of them do. Where one of them alone comes to zero,
// the slip goes on along the edge between two sides of the polygon.
template <class Element>
void compareDirections(const Element &element, int number, const Mode &from, const Mode &to, std::vector<Transition> &transitions) {
  const auto sticks = [&element](const Mode &mode) {
    const auto first = mode.tangent.begin() + element.tangent_first;
    return std::all_of(first, first + element.tangent_count, [](Tangent tangent) { return tangent == Tangent::Stick; });
  };
  const bool stuck = sticks(from), isStuck = sticks(to);
  if (stuck != isStuck) {
    transitions.push_back({isStuck ? TF_EVENT_STICK : TF_EVENT_SLIP, number});
    return;
  }
  bool changes = false, comesToZero = false;
  for (int row = element.tangent_first; row < element.tangent_first + element.tangent_count; ++row) {
    const Tangent a = from.tangent[row], b = to.tangent[row];
    changes = changes || (a != b && a != Tangent::None);
    comesToZero = comesToZero || (a != b && a != Tangent::None && b == Tangent::Stick);
  }
  if (changes)
    transitions.push_back({comesToZero ? TF_EVENT_SLIDING : TF_EVENT_SLIP_REVERSAL, number});
}

// Both rows of a slip of two components change together: the first one tells. Of a relaxed slip the edge does.
template <class Element>
void compareTangent(const Element &element, int number, const Mode &from, const Mode &to, std::vector<Transition> &transitions) {
  if (element.tangent_count == 0)
    return;
  const int row = element.tangent_first + (element.friction_form == TF_FRICTION_RELAXED ? TF_RELAXED_EDGE_ROW : 0);
  const Tangent a = from.tangent[row], b = to.tangent[row];
  if (element.friction_form == TF_FRICTION_POLYHEDRAL && b != Tangent::None)
    return compareDirections(element, number, from, to, transitions);
  if (a == b || b == Tangent::None)
    return;
  if (b == Tangent::Stick)
    transitions.push_back({TF_EVENT_STICK, number});
  else if (a == Tangent::Stick)
    transitions.push_back({TF_EVENT_SLIP, number});
  else if (a != Tangent::None)
    transitions.push_back({TF_EVENT_SLIP_REVERSAL, number});
}

}  // namespace

int elementOfTangent(const tf_model &model, int row) {
  for (int i = 0; i < model.nc; ++i)
    if (hasTangent(model.contacts[i], row))
      return i;
  for (int f = 0; f < model.nf; ++f)
    if (hasTangent(model.frictions[f], row))
      return model.nc + f;
  return -1;
}

void compareModes(const tf_model &model, const Mode &from, const Mode &to, std::vector<Transition> &transitions) {
  if (from.closed != to.closed)
    for (int i = 0; i < model.nc; ++i)
      if (from.closed[i] != to.closed[i])
        transitions.push_back({to.closed[i] ? TF_EVENT_CLOSING : TF_EVENT_OPENING, i});
  if (from.tangent != to.tangent) {
    for (int i = 0; i < model.nc; ++i)
      compareTangent(model.contacts[i], i, from, to, transitions);
    for (int f = 0; f < model.nf; ++f)
      compareTangent(model.frictions[f], model.nc + f, from, to, transitions);
  }
  if (from.switches.empty())
    return;
  for (int j = 0; j < model.ns; ++j) {
    if (from.switches[j] == to.switches[j] || model.switches[j].kind == TF_SWITCH_REST)
      continue;
    const int kind = to.switches[j] == Switch::Sliding          ? TF_EVENT_SLIDING
                     : model.switches[j].kind == TF_SWITCH_TIME ? TF_EVENT_TIME
                                                                : TF_EVENT_STATE;
    transitions.push_back({kind, model.nc + model.nf + j});
  }
}

}  // namespace tf::runtime
