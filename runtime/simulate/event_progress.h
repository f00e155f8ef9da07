// Whether events leave the run any progress. Impacts that accumulate are no such case: they are carried through.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tf::runtime {

class EventProgress {
public:
  // `number` of contacts, friction elements and switches: each may have events of its own.
  void start(double time, int number) { *this = {time, time, 0, number}; }
  // Another event at `time`. False: so many have come within so short a time that the run would never end.
  bool add(double time);

  // Plain data, of which continuation depends: when the run and when the count began, the events since then, and the number of elements.
  double begin = 0, since = 0;
  int count = 0;
  int elements = 0;
};

// Switches whose condition returns to zero for ever, ever nearer to it: the end of infinitely many switches, behind which only rounding
// errors decide.
class SwitchProgress {
public:
  void start(int switches);
  // Switch j changes, between whose last change and now its condition has had this value. False: that has been no more than rounding for
  // long.
  bool add(int j, double between);
  // Switch j has changed at `time`.
  void changed(int j, double time);
  // Several changes of switch j have come just before `time`: it has been no longer since the last one than between them.
  [[nodiscard]] bool isRapid(int j, double time) const;

private:
  static constexpr std::size_t several = 4;

  std::vector<int> faint_;                           // changes in a row, of each switch
  std::vector<std::array<double, several>> latest_;  // their times, of each switch, the last one first
};

}  // namespace tf::runtime
