// Contact rows in the metric of the mass matrix: J, D = J W Jᵀ and φ = J W f + bias (theory.md section 1) for a choice of rows. Rows are
// taken through half of the factorisation only, Z = L⁻¹ P Jᵀ, on the blocks of the mass matrix that they move: D = Zᵀ Δ⁻¹ Z, and W Jᵀ λ is
// one second half for all rows together.
//
// Bodies that lie flat have several contacts that slip as one: rows that are equal to rounding go through the factorisation once.
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/integrate/dot.h"
#include "runtime/integrate/model_evaluation.h"
#include "runtime/integrate/tangent_roles.h"

#include <span>
#include <vector>

namespace tf::runtime {

class RowSystem {
public:
  // Up to so many velocities, rows are read as a whole: that costs no more than looking for their zeros. They go through the factorisation
  // as a whole only where blocks of the mass matrix have code of their own (MassMatrix::fixedSize).
  static constexpr int narrow = 8;

  // Normal rows of `contacts`, then the tangential rows `tangents` (increasing numbers of the model's table; a row of a contact needs its
  // contact among `contacts`, both rows of a slip are there or none). Fills owners and partners of `problem`.
  void choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents, ContactRows &problem);

  // J and Z at the evaluation's point (dynamics and contactTerms have been called there), D and the rows' friction and bounds.
  void assemble(const ModelEvaluation &at, DenseMatrix &delassus, ContactRows &rows) {
    gather(at, rows);
    respond(at, delassus);
  }
  // J, friction and bounds alone. The second row of a pair with slipSign ≠ 0 has none: its frame lies along the slip.
  void gather(const ModelEvaluation &at, ContactRows &rows) {
    gatherRows(at);
    gatherLimits(at, rows);
  }
  void gatherRows(const ModelEvaluation &at);
  void gatherLimits(const ModelEvaluation &at, ContactRows &rows) const;
  // Z and D, of the rows gathered at the same point. Equal rows have equal entries.
  void respond(const ModelEvaluation &at, DenseMatrix &delassus);
  // bias_i = J_i · acceleration + bias of the row
  void bias(const ModelEvaluation &at, const double *freeAcceleration, std::vector<double> &bias) const;
  // acceleration += W Jᵀ forces, with the mobility of the last `respond` as it is now
  void accelerate(const double *forces, double *acceleration) const;
  // target [nv] += J_iᵀ force
  void addForce(int row, double force, double *target) const {
    for (const Span &span : spansOf(row))
      for (int k = span.begin; k < span.end; ++k)
        target[k] += jacobian(row)[k] * force;
  }
  // target [nv] += Jᵀ forces
  void addForces(const double *forces, double *target) const;
  // J_i · x
  [[nodiscard]] double product(int row, const double *x) const {
    double sum = 0;
    for (const Span &span : spansOf(row))
      sum += dot(jacobian(row) + span.begin, x + span.begin, span.end - span.begin);
    return sum;
  }
  // The velocity terms of the row's acceleration (normalBias, tangentBias) at the evaluation's point.
  [[nodiscard]] double modelBias(const ModelEvaluation &at, int row) const {
    return row < normalCount() ? at.normalBias[contacts_[row]] : tangentValue(at.tangentBias.data(), 1, row - normalCount());
  }

  // Whether rows [width()] are equal to rounding, in their first `count` entries.
  [[nodiscard]] static bool areEqual(const double *x, const double *y, int count);
  // Where row i is among the model's, not gathered; nullptr: its frame makes it another one.
  [[nodiscard]] const double *modelRow(const ModelEvaluation &at, int i) const {
    if (i < normalCount())
      return at.normal.data() + static_cast<std::ptrdiff_t>(contacts_[i]) * nv_;
    const int j = i - normalCount();
    return side_[j] == 0 ? at.tangent.data() + static_cast<std::ptrdiff_t>(tangents_[j]) * nv_ : nullptr;
  }

  [[nodiscard]] const double *jacobian(int row) const { return jacobian_.data() + static_cast<std::ptrdiff_t>(row) * nv_; }

  // The rows of a slip with two components are a pair in a frame of its own: row j = c·(first row) + s·(second row), row j + 1 =
  // c·second − s·first. `choose` sets c = 1, s = 0.
  void setFrame(int j, double c, double s) { frame_[j] = {c, s}; }
  // Row j (from 0, of the tangential rows here) of a quantity with one value for each tangential row of the model, `stride` apart.
  [[nodiscard]] double tangentValue(const double *modelRows, int stride, int j) const;
  // Forces of the tangential rows here into those of the model [nt]; other rows keep theirs.
  void spreadTangentForces(const double *forces, double *modelForces) const {
    for (std::size_t j = 0; j < tangents_.size(); ++j)
      if (side_[j] == 0)
        modelForces[tangents_[j]] = forces[j];
      else
        spreadTurned(static_cast<int>(j), forces, modelForces);
  }

  // The first row that is equal to row i to rounding; and where its last entries that are zero begin. Of rows that have been gathered,
  // wider than `narrow`.
  [[nodiscard]] int firstEqual(int i) const { return twin_[i]; }
  [[nodiscard]] int uniqueCount() const { return static_cast<int>(first_.size()); }
  [[nodiscard]] int endOf(int i) const { return firstSpan_[i] < firstSpan_[i + 1] ? spans_[firstSpan_[i + 1] - 1].end : 0; }

  // Number of velocities.
  [[nodiscard]] int width() const { return nv_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int normalCount() const { return normalCount_; }
  [[nodiscard]] const std::vector<int> &contacts() const { return contacts_; }
  [[nodiscard]] const std::vector<int> &tangents() const { return tangents_; }

private:
  struct Frame {
    double c = 1, s = 0;
  };

  void spreadTurned(int j, const double *forces, double *modelForces) const;

  std::vector<int> contacts_, tangents_;
  std::vector<int> owner_, pair_;  // nt: of all tangential rows of the model
  std::vector<int> contactOf_;     // of a tangential row: contact or −1
  std::vector<int> side_;          // of a tangential row: 0 alone, 1 first of a pair, 2 second
  std::vector<Frame> frame_;       // of the first row of a pair
  // A row of Z on one block of the mass matrix.
  struct Part {
    int row = 0;
    int first = 0;  // place before which it is zero
  };

  // The parts of rows on one large block: places × rows, padded (dense_kernels.h).
  struct Panel {
    int stride = 0;
    std::vector<double> half, scaled;
  };

  // Columns of a row of J; outside all of its spans it is zero. Of a contact between two bodies they are those of their coordinates.
  struct Span {
    int begin = 0, end = 0;
  };

  [[nodiscard]] std::span<const Span> spansOf(int row) const {
    return {spans_.data() + firstSpan_[row], spans_.data() + firstSpan_[row + 1]};
  }
  void findSpans(int row);
  void prepareTwins();
  void findTwin(int i, double mark);
  void copyTwins(DenseMatrix &delassus) const;
  const double *sumOverTwins(const double *forces) const;
  [[nodiscard]] bool isWhole() const { return nv_ <= MassMatrix::fixedSize; }
  void respondAsWhole(DenseMatrix &delassus);
  void halve(int i);
  [[nodiscard]] bool isPanel(int block) const { return !mobility_->isConstrained() && mobility_->mass().isLarge(block); }
  void halvePanel(int block);
  void multiply(DenseMatrix &delassus);
  void multiplyPanel(int block, DenseMatrix &delassus);
  bool addPanel(int block, const double *forces) const;
  bool sumAsWhole(const double *forces) const;
  bool sumBlocks(const double *forces) const;

  int nv_ = 0, normalCount_ = 0, count_ = 0;
  const Mobility *mobility_ = nullptr;
  std::vector<double> jacobian_;          // count × nv, row-major
  std::vector<double> half_, scaled_;     // Zᵀ and Zᵀ Δ⁻¹, alike; undefined on blocks that the row does not move
  std::vector<std::vector<Part>> parts_;  // of blocks, rows ascending
  std::vector<Span> spans_;               // row by row, ascending; all columns of rows that are read as a whole
  std::vector<int> firstSpan_;            // count + 1
  bool hasTwins_ = false;                 // rows gathered last are equal to others
  std::vector<int> twin_;                 // of a row: the first row that is equal to it
  std::vector<int> first_;                // rows that are equal to none before
  std::vector<double> marker_, mark_;     // nv; of each of first_: its product with the marker
  std::vector<Panel> panels_;             // of blocks
  std::vector<double> product_;           // of panels
  std::vector<double> zero_;              // a row
  mutable std::vector<double> panelForce_, twinForce_;
  mutable std::vector<double> sum_;  // workspaces: nv
};

}  // namespace tf::runtime
