// What changed from one mode to the next: the events that are reported.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/integrate/mode.h"

#include <vector>

namespace tf::runtime {

struct Transition {
  int kind;     // TF_EVENT_…
  int element;  // contact, nc + friction element, nc + nf + switch; −1: none
};

// Of events: the contact, or nc + friction element, of a tangential row of the model; −1 if there is none.
int elementOfTangent(const tf_model &model, int row);

// Appends the differences of the modes; the switches of `from` are empty before a run's first mode.
void compareModes(const tf_model &model, const Mode &from, const Mode &to, std::vector<Transition> &transitions);

}  // namespace tf::runtime
