// Whether events leave the run any progress of physical time. Impacts that accumulate are no such case: they are carried through.
#pragma once

namespace tf::runtime {

class EventProgress {
public:
  // `number` of contacts, friction elements and switches: each may have events of its own.
  void start(double time, int number) { *this = {time, 0, number}; }
  // Another event at `time`. False: so many have come within so short a time that the run would never end.
  bool add(double time);

  // Plain data, of which continuation depends: when the count began, the events since then, and the number of elements.
  double since = 0;
  int count = 0;
  int elements = 0;
};

}  // namespace tf::runtime
