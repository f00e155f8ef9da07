// Contact rows in the metric of the mass matrix: J, W Jᵀ, D = J W Jᵀ and φ = J W f + bias (theory.md section 1) for a choice of rows.
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/integrate/model_evaluation.h"

#include <vector>

namespace tf::runtime {

class RowSystem {
public:
  // Normal rows of `contacts`, then the tangential rows `tangents` (numbers of the model's table; a row of a contact needs its contact
  // among `contacts`). Fills owners of `problem`.
  void choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents, ContactRows &problem);

  // J and W Jᵀ at the evaluation's point (dynamics and contactTerms have been called there), D and the rows' friction and bounds.
  void assemble(const ModelEvaluation &at, DenseMatrix &delassus, ContactRows &rows);
  // bias_i = J_i · acceleration + bias of the row
  void bias(const ModelEvaluation &at, const double *freeAcceleration, std::vector<double> &bias) const;
  // acceleration += W Jᵀ forces
  void accelerate(const double *forces, double *acceleration) const;
  // target += Jᵀ forces
  void addForces(const double *forces, double *target) const;
  // J_i · x
  [[nodiscard]] double product(int row, const double *x) const;

  [[nodiscard]] int count() const { return static_cast<int>(contacts_.size() + tangents_.size()); }
  [[nodiscard]] int normalCount() const { return static_cast<int>(contacts_.size()); }
  [[nodiscard]] const std::vector<int> &contacts() const { return contacts_; }
  [[nodiscard]] const std::vector<int> &tangents() const { return tangents_; }

private:
  std::vector<int> contacts_, tangents_;
  std::vector<int> contactOf_;  // of a tangential row: contact or −1
  int nv_ = 0;
  std::vector<double> jacobian_, mobility_;  // count × nv, row-major
};

// Contact of a tangential row of the model, −1 for a row of a friction element.
[[nodiscard]] std::vector<int> contactsOfTangents(const tf_model &model);

}  // namespace tf::runtime
