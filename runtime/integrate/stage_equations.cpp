#include "runtime/integrate/stage_equations.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace tf::runtime {

StageEquations::StageEquations(int size, std::vector<double> coefficients)
    : n_(size), stages_(static_cast<int>(std::lround(std::sqrt(static_cast<double>(coefficients.size()))))), words_((size + 63) / 64),
      coefficients_(std::move(coefficients)), jacobians_(static_cast<std::size_t>(stages_), Eigen::MatrixXd(size, size)),
      known_(size, stages_) {}

// The transitive and reflexive closure of what the Jacobians of the stages have no zero at (Warshall).
void StageEquations::findDependencies() {
  direct_.assign(static_cast<std::size_t>(n_) * static_cast<std::size_t>(words_), 0);
  for (const Eigen::MatrixXd &jacobian : jacobians_)
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i < n_; ++i)
        if (jacobian(i, j) != 0)
          direct_[static_cast<std::size_t>(i) * words_ + j / 64] |= std::uint64_t{1} << (j % 64);
  reach_ = direct_;
  for (int i = 0; i < n_; ++i)
    reach_[static_cast<std::size_t>(i) * words_ + i / 64] |= std::uint64_t{1} << (i % 64);
  for (int k = 0; k < n_; ++k) {
    const std::uint64_t *through = reach_.data() + static_cast<std::ptrdiff_t>(k) * words_;
    for (int i = 0; i < n_; ++i)
      if (i != k && isSet(reach_, i, k))
        for (int w = 0; w < words_; ++w)
          reach_[static_cast<std::size_t>(i) * words_ + w] |= through[w];
  }
}

// A variable that depends on those of another part depends on all that these depend on, and on itself.
void StageEquations::splitParts() {
  findDependencies();
  const auto size = static_cast<std::size_t>(n_);
  reachCounts_.assign(size, 0);
  for (std::size_t i = 0; i < size; ++i)
    for (int w = 0; w < words_; ++w)
      reachCounts_[i] += std::popcount(reach_[i * words_ + w]);
  const auto count = [this](int i) { return reachCounts_[static_cast<std::size_t>(i)]; };
  order_.resize(size);
  std::iota(order_.begin(), order_.end(), 0);
  std::sort(order_.begin(), order_.end(), [&count](int a, int b) { return std::pair(count(a), a) < std::pair(count(b), b); });
  isInPart_.assign(size, 0);
  partCount_ = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const int first = order_[k];
    if (isInPart_[static_cast<std::size_t>(first)] != 0)
      continue;
    members_.assign(1, first);
    for (std::size_t l = k + 1; l < size && count(order_[l]) == count(first); ++l)
      if (isSet(reach_, first, order_[l]) && isSet(reach_, order_[l], first))
        members_.push_back(order_[l]);
    for (const int member : members_)
      isInPart_[static_cast<std::size_t>(member)] = 1;
    if (partCount_ == parts_.size())
      parts_.emplace_back();
    chooseEliminated(members_, parts_[partCount_++]);
  }
}

// Variables with few entries in their rows and none among themselves.
void StageEquations::chooseEliminated(const std::vector<int> &members, Part &part) const {
  constexpr int mostEntries = 2;
  const auto depends = [this](int i, int j) { return isSet(direct_, i, j); };
  part.eliminated.clear();
  part.rest.clear();
  for (const int i : members) {
    const auto entries = std::count_if(members.begin(), members.end(), [&](int j) { return depends(i, j); });
    const bool isFree = entries <= mostEntries && !depends(i, i) &&
                        std::none_of(part.eliminated.begin(), part.eliminated.end(), [&](int e) { return depends(i, e) || depends(e, i); });
    (isFree ? part.eliminated : part.rest).push_back(i);
  }
}

void StageEquations::factorise(double h) {
  h_ = h;
  splitParts();
  for (std::size_t k = 0; k < partCount_; ++k)
    factorise(parts_[k]);
}

// With (1, −h A ⊗ J_er; −h A ⊗ J_re, 1 − h A ⊗ J_rr): 1 − h A ⊗ J_rr − h² (A ⊗ J_re) (A ⊗ J_er).
void StageEquations::factorise(Part &part) {
  const auto count = static_cast<Eigen::Index>(part.rest.size());
  if (count == 0)
    return;
  schur_.resize(count * stages_, count * stages_);
  for (int i = 0; i < stages_; ++i)
    for (int k = 0; k < stages_; ++k) {
      auto block = schur_.block(i * count, k * count, count, count);
      block = -h_ * coefficient(i, k) * jacobians_[static_cast<std::size_t>(k)](part.rest, part.rest);
      if (part.eliminated.empty())
        continue;
      coupling_.setZero(count, static_cast<Eigen::Index>(part.eliminated.size()));
      for (int j = 0; j < stages_; ++j)
        coupling_ += h_ * h_ * coefficient(i, j) * coefficient(j, k) * jacobians_[static_cast<std::size_t>(j)](part.rest, part.eliminated);
      for (std::size_t e = 0; e < part.eliminated.size(); ++e)
        for (Eigen::Index r = 0; r < count; ++r)
          if (const double entry = jacobians_[static_cast<std::size_t>(k)](part.eliminated[e], part.rest[static_cast<std::size_t>(r)]);
              entry != 0)
            block.col(r) -= entry * coupling_.col(static_cast<Eigen::Index>(e));
    }
  schur_.diagonal().array() += 1;
  part.factor.compute(schur_);
}

// The right-hand sides of a part: what the variables before it add to its stages is known.
void StageEquations::gather(const Part &part, const Eigen::VectorXd &stages) {
  const auto collect = [&](const std::vector<int> &variables, Eigen::MatrixXd &values) {
    values.resize(static_cast<Eigen::Index>(variables.size()), stages_);
    for (int i = 0; i < stages_; ++i)
      for (std::size_t v = 0; v < variables.size(); ++v) {
        double sum = 0;
        for (int j = 0; j < stages_; ++j)
          sum += coefficient(i, j) * known_(variables[v], j);
        values(static_cast<Eigen::Index>(v), i) = stages[i * n_ + variables[v]] + h_ * sum;
      }
  };
  collect(part.eliminated, eliminatedValues_);
  collect(part.rest, restValues_);
}

void StageEquations::spread(const std::vector<int> &variables, const Eigen::MatrixXd &values, Eigen::VectorXd &stages) {
  for (int j = 0; j < stages_; ++j)
    for (std::size_t v = 0; v < variables.size(); ++v) {
      const double value = values(static_cast<Eigen::Index>(v), j);
      stages[j * n_ + variables[v]] = value;
      if (value != 0)
        known_.col(j) += value * jacobians_[static_cast<std::size_t>(j)].col(variables[v]);
    }
}

void StageEquations::solve(Eigen::VectorXd &stages) {
  known_.setZero();
  for (std::size_t k = 0; k < partCount_; ++k) {
    const Part &part = parts_[k];
    gather(part, stages);
    const auto count = static_cast<Eigen::Index>(part.rest.size()), others = static_cast<Eigen::Index>(part.eliminated.size());
    // h (A ⊗ J) times the values of the stages.
    const auto add = [&](const std::vector<int> &rows, const std::vector<int> &columns, const Eigen::MatrixXd &from, Eigen::MatrixXd &to) {
      product_.resize(static_cast<Eigen::Index>(rows.size()), stages_);
      for (int j = 0; j < stages_; ++j)
        product_.col(j).noalias() = jacobians_[static_cast<std::size_t>(j)](rows, columns) * from.col(j);
      for (int i = 0; i < stages_; ++i)
        for (int j = 0; j < stages_; ++j)
          to.col(i) += h_ * coefficient(i, j) * product_.col(j);
    };
    if (count > 0) {
      if (others > 0)
        add(part.rest, part.eliminated, eliminatedValues_, restValues_);
      right_ = restValues_.reshaped();
      restValues_ = part.factor.solve(right_).reshaped(count, stages_);
      if (others > 0)
        add(part.eliminated, part.rest, restValues_, eliminatedValues_);
    }
    spread(part.eliminated, eliminatedValues_, stages);
    spread(part.rest, restValues_, stages);
  }
}

}  // namespace tf::runtime
