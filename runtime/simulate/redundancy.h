// Constraints that follow from others: which ones, from when on, and whether they agree with what they follow from (theory.md section 1: W
// has the pseudo-inverse, so that motion goes on whatever the rank of H is).
#pragma once

#include "runtime/integrate/model_evaluation.h"

#include <string>
#include <vector>

namespace tf::runtime {

class Redundancy {
public:
  explicit Redundancy(ModelEvaluation &evaluation) : at_(evaluation) {}

  // A run begins.
  void start();
  // Rows become other ones, or the run begins: all of them count until `choose`.
  void forgetChoice();
  // At coordinates q [nq] where the constraints hold and the dynamics has been evaluated: from now on independent rows stand for all where
  // some follow from others (Mobility::chooseIndependent). True: the dynamics is to be evaluated anew.
  bool choose(const double *q);
  // Constraint rows depend on each other at the evaluation's point, or did at the last choice.
  [[nodiscard]] bool isExpected() const { return isPresent() || at_.mobility.wasRedundant(); }
  // Constraint rows depend on each other at the evaluation's point.
  [[nodiscard]] bool isPresent() const { return at_.mobility.rank() < at_.model().nh; }
  // Of each row that follows from others for the first time of the run, at the evaluation's point: "constraint 'b' follows from 'a'
  // (m.tf:7)".
  std::vector<std::string> newlyRedundant();
  // Constraints that are not satisfied there: "constraints 'a' and 'b' contradict each other …"; empty where all is well. `tolerance` is
  // that of the run: what a constraint that is dependent for an instant only has lost by then is no contradiction.
  std::string contradiction(double tolerance);
  // "at a singular position of constraint 'a' (m.tf:7) …" where rows that are independent, at the latest evaluation's point, are held so
  // little, measured by what they are around the start, that rounding of the residuals turns the velocities by far more than `tolerance`:
  // it would decide on which branch the mechanism goes on.
  [[nodiscard]] std::string singularity(double tolerance) const;
  // The same text, of the row that is the least independent there.
  [[nodiscard]] std::string undecided(double tolerance) const;
  // The most rows that have followed from others at once.
  [[nodiscard]] int most() const { return most_; }

private:
  [[nodiscard]] std::string nameOf(int row) const;
  [[nodiscard]] const tf_constraint &constraintOf(int row) const;

  ModelEvaluation &at_;
  std::vector<bool> reported_;       // rows
  std::vector<double> choicePoint_;  // coordinates of the last choice that may leave out more rows than before; empty: there is none
  int most_ = 0;
};

}  // namespace tf::runtime
