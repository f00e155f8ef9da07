// Whether events leave the run any progress of physical time. Impacts that accumulate are no such case: they are carried through.
#pragma once

namespace tf::runtime {

class EventProgress {
public:
  void start(double time) { *this = {time, 0}; }
  // Another event at `time`. False: so many have come within so short a time that the run would never end.
  bool add(double time);

  // Plain data, of which continuation depends: when the count began, and the events since then.
  double since = 0;
  int count = 0;
};

}  // namespace tf::runtime
