// Which contacts are too far from closing to be looked at. Around a point of the motion lies a box of coordinates (and of the time, where
// gaps depend on it) with a bound for the change of each gap inside it (tf_model::gap_bounds): a contact whose gap is larger than its bound
// is asleep, its gap is positive wherever the motion goes inside the box. The box is chosen anew when the motion leaves it, as large as
// makes the fewest gaps to be read.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/integrate/contact_scales.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tf::runtime {

class GapScreen {
public:
  // The scales must outlive the screen.
  GapScreen(const tf_model &model, const ContactScales &scales);

  // Without it all contacts are awake.
  [[nodiscard]] bool isUsed() const { return model_->gap_bounds != nullptr; }
  // Begins anew: at another motion, or with other parameters.
  void forget();
  // The contacts [nc] that are awake wherever they are.
  void hold(const std::uint8_t *contacts);
  // Whether the point is in the box.
  [[nodiscard]] bool covers(double time, const double *q) const;
  // Whether another box is within it: nq + 1 each.
  [[nodiscard]] bool covers(const double *center, const double *radius) const;

  // A new box around the point of the arguments `in` of generated functions, with the coordinates' rates there; or around the `center`,
  // with the half-widths `least` at least (nq + 1 each: coordinates and time). `gap` becomes the gaps at its centre.
  void renew(const double *const *in, const double *rate, double *gap, const double *center = nullptr, const double *least = nullptr);

  // nc
  [[nodiscard]] const std::uint8_t *awake() const { return awake_.data(); }
  // Few contacts are awake: a smaller box would not leave far fewer.
  [[nodiscard]] bool isSelective() const;
  [[nodiscard]] bool isAwake(int contact) const { return awake_[contact] != 0; }
  // Changes whenever `awake` does.
  [[nodiscard]] long long revision() const { return revision_; }
  // The gaps that are awake have been read.
  void count() { ++reads_; }

private:
  void balance();
  void evaluate(const double *const *in, double *gap, const double *least);
  [[nodiscard]] int countNear(double share) const;
  void merge();

  const tf_model *model_;
  const ContactScales *scales_;
  bool dependsOnTime_ = false;
  bool isValid_ = false, hasSpan_ = false;
  double span_ = 1;                      // the box reaches as far as the motion goes in this time
  std::vector<double> speed_;            // nq: of the coordinates, lately
  std::vector<double> center_, radius_;  // nq + 1
  std::vector<double> bound_, ratio_;    // nc
  std::vector<double> clearance_;        // nc: the gaps at the centre, less what may be an error or a touch
  std::vector<std::uint8_t> isNear_, held_, awake_;
  long long revision_ = 0, reads_ = 0;
  // Contacts that would be awake in boxes of these shares of the size; known where it has been chosen.
  static constexpr std::array shares = {1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1.0, 2.0};
  std::array<int, shares.size()> near_{};
  bool isBalanced_ = false;
};

}  // namespace tf::runtime
