// Restitution while time is frozen (theory.md section 3): what a contact stores in its compression, and how long it goes on pushing for it.
//   Poisson  p' = a ε in compression, −a in restitution, which ends at p = 0; where several contacts have pushed, also at w = 0
//            (w' = −a c2): Poisson's law alone would let several contacts gain energy
//   Stronge  w' = −a ε² c2 in compression, −a c2 in restitution, which ends at w = 0
//   Newton   pushes until c2 = −ε c2⁻: the same automaton as without restitution, in c2 less this target
// Velocities below are c2 less the target. Contacts that are held at zero by others store nothing. How the velocities move while the
// contacts push (friction in one or two directions) is no business of this class.
#pragma once

#include "runtime/contact/numbers.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace tf::runtime {

enum class ImpactLaw : std::uint8_t { Poisson = 0, Stronge = 1, Newton = 2 };  // the values of enum tf_impact_law

// Nothing moves, but for rounding: rows whose forces press against one another, as in a wedge that friction holds. Both of all rows: w = D
// λ, and Σ |D λ| of its terms.
[[nodiscard]] inline bool standsStill(std::span<const double> acceleration, std::span<const double> turnover) {
  for (std::size_t r = 0; r < acceleration.size(); ++r)
    if (std::abs(acceleration[r]) > standstill * turnover[r])
      return false;
  return true;
}

class Restitution {
public:
  // A phase begins; all arrays have one entry per contact: ε ≥ 0, law, a > 0, and c2 before the impact.
  void begin(std::span<const double> coefficient, std::span<const ImpactLaw> law, std::span<const double> rate,
             std::span<const double> normalVelocity);

  // −ε c2⁻ of Newton's law where the contact approached, else 0.
  [[nodiscard]] double target(int i) const { return target_[i]; }
  // The contact pushes at its full rate although its velocity is not negative.
  [[nodiscard]] bool stored(int i) const {
    return law_[i] == ImpactLaw::Stronge ? work_[i] > 0 : impulse_[i] > 0 && (!several_ || work_[i] > 0);
  }
  // Its push may end because it has given back its work.
  [[nodiscard]] bool endsByWork(int i) const { return work_[i] > 0 && (law_[i] == ImpactLaw::Stronge || several_); }
  [[nodiscard]] bool storesWork(int i) const { return coefficient_[i] > 0 && law_[i] != ImpactLaw::Newton; }
  [[nodiscard]] double impulse(int i) const { return impulse_[i]; }
  [[nodiscard]] double work(int i) const { return work_[i]; }

  // These contacts (force > 0) push. True if the rule for several contacts holds from now on and has ended the push of one of them.
  bool push(std::span<const double> force);

  // Time until the contact has used up what it stores, while its velocity moves as velocity + acceleration t and does not cross zero.
  [[nodiscard]] double exhaustion(int i, double velocity, double acceleration) const;
  // A piece of such a path. `exhausted`: it ends where the contact has used up what it stores.
  void advance(int i, double velocity, double acceleration, double duration, bool exhausted);
  // Both of a path that may cross zero.
  [[nodiscard]] double exhaustionThroughZero(int i, double velocity, double acceleration) const;
  void advanceThroughZero(int i, double velocity, double acceleration, double duration, bool exhausted);
  // Where nothing moves, or a cycle repeats: contacts that no longer approach, but for rounding(i), give up what they store and the target
  // that they push for in vain, and those that compress by rounding alone no longer do; `velocity` and `force` are of all contacts. `ends`:
  // nothing would end this; Poisson's push does by itself. False if there are no such contacts.
  template <typename Rounding> bool giveUp(std::span<double> velocity, std::span<const double> force, const Rounding &rounding, bool ends) {
    bool any = false;
    for (int i = 0; i < static_cast<int>(target_.size()); ++i) {
      if (velocity[i] + target_[i] < -rounding(i))
        continue;
      const bool isTarget = target_[i] > 0 && force[i] > 0;
      const bool isStore = stored(i) && velocity[i] >= 0 && (ends || law_[i] != ImpactLaw::Poisson);
      const bool isRounding = stored(i) && velocity[i] < 0;
      if (isTarget || isStore)
        velocity[i] += discard(i);
      if (isTarget || isStore || isRounding)
        velocity[i] = std::abs(velocity[i]) <= rounding(i) ? 0 : velocity[i];
      any = any || isTarget || isStore || isRounding;
    }
    return any;
  }
  // Values at the end of infinitely many pieces.
  void set(int i, double impulse, double work);

private:
  // Returns what the target was.
  double discard(int i);
  [[nodiscard]] double workExhaustion(int i, double work, double velocity, double acceleration) const;
  [[nodiscard]] double exhaustion(int i, double impulse, double work, double velocity, double acceleration) const;
  [[nodiscard]] double workOf(int i, double velocity, double acceleration, double duration) const;

  std::vector<double> coefficient_, rate_, target_;
  std::vector<ImpactLaw> law_;
  std::vector<double> impulse_, work_;                    // p, w
  std::vector<double> impulseMagnitude_, workMagnitude_;  // what they are sums of
  std::vector<std::uint8_t> pushed_;
  bool several_ = false;
};

}  // namespace tf::runtime
