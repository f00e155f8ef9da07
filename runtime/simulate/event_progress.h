// Whether events leave the run any progress. Impacts that accumulate are no such case: they are carried through.
#pragma once

#include <vector>

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

// Switches whose condition returns to zero for ever, ever nearer to it: the end of infinitely many switches, behind which only rounding
// errors decide.
class SwitchProgress {
public:
  void start(int switches) { faint_.assign(switches, 0); }
  // Switch j changes, between whose last change and now its condition has had this value. False: that has been no more than rounding for
  // long.
  bool add(int j, double between);

private:
  std::vector<int> faint_;  // changes in a row, of each switch
};

}  // namespace tf::runtime
