// Suggestions for misspelt names of variables.
#pragma once

#include <string>
#include <string_view>

namespace tf::runtime {

// Optimal string alignment distance: insertions, deletions, replacements (also of case) and exchanges of neighbours. limit + 1 if it
// exceeds `limit`.
int editDistance(std::string_view a, std::string_view b, int limit);

// Keeps the candidate nearest to what was written; near is a distance of at most a third of the written length, between 1 and 4.
class NearestName {
public:
  explicit NearestName(std::string_view written);
  void offer(std::string_view candidate);
  // "" if no candidate was near, otherwise "; did you mean 'NAME'?".
  [[nodiscard]] std::string suggestion() const;

private:
  std::string written_, best_;
  int distance_;  // of best_; one more than what counts as near while there is none
};

}  // namespace tf::runtime
