// The contact forces and the accelerations of a mode whose bodies are linked one to the next, in O(n) (SemiseparableSystem): neither M nor
// D is factorised. The same equations as ModeForces, for rows that are independent, or redundant because some of them are equal, or were so
// when the mode began, as the slips of a chain that lies flat: these have equal shares of their sum, but for those whose friction is at its
// limit. What else redundant rows may need is left to ModeForces.
#pragma once

#include "runtime/contact/mode_forces.h"
#include "runtime/integrate/row_system.h"
#include "runtime/integrate/semiseparable_system.h"

#include <vector>

namespace tf::runtime {

class LinkedForces {
public:
  // Begins a mode in which all normal rows of `rows` are closed, at the evaluation's point, where the rows have been gathered and `start`
  // has been evaluated. False: it is not of this kind; that may show in the first evaluation only.
  bool choose(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem, const ContactMode &mode,
              const ModeForces &start);

  // Part of the forces that nobody notices.
  void setForceError(double error) { forceError_ = error; }

  // What evaluate() needs to know of M at a point near those before: a sample, or M itself (null).
  [[nodiscard]] MassSample *sample(const ModelEvaluation &at);

  // Forces, into `forces`, and accelerations [nv] at the evaluation's point, where sample() has been evaluated. `rows` are gathered there
  // where what is known of them from other points does not do. Allocates nothing once it has seen the largest system. False: it is not of
  // this kind there, or singular.
  bool evaluate(ModelEvaluation &at, RowSystem &rows, const ContactProblem &problem, double *acceleration, ModeForces &forces);

  // change [nv] += M⁻¹ Jᵀ x with J M⁻¹ Jᵀ x = `residual` [rows] on the rows that take part, as of the evaluation that was last. Equal rows
  // have equal residuals but for rounding: the first one's counts. False: this mode was not evaluated here, or the rows (nearly) depend on
  // each other.
  bool correct(ModelEvaluation &at, const std::vector<std::uint8_t> &takesPart, const double *residual, double *change);

private:
  // Of the rows that take part in a correction: normal rows for coordinates, those that stick as well for velocities.
  struct Correction {
    Correction() { system.followDeterminant(false); }

    SemiseparableSystem system{1e-6};
    std::vector<int> rows, unknowns;  // the first of equal ones; their numbers in rows_
    bool isKnown = false;             // `system` has been factorised with these rows, in this mode,
    bool isCurrent = false;           // at the point of the last evaluation
  };
  bool factorise(ModelEvaluation &at, Correction &correction);

  // A tangential row whose friction is at its limit: its number, the place of its contact's normal row (−1: a friction element), and the
  // sign of the slip that it is opposed to. One that sticks all the same has equal rows that share what it leaves.
  struct Limited {
    int row = 0, place = -1;
    double sign = 1;
    bool sticks = false;
  };
  // Active rows whose forces are one unknown, for they are equal; and the one that is an equation.
  struct Set {
    int row = 0, count = 0, equation = -1;
  };

  // A set whose rows are nearly those of another one, with `count` of which it shares one force.
  struct Joined {
    int set = 0, number = 0, count = 0;
  };

  bool factorise(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem);
  bool refactorise(const ModelEvaluation &at, const RowSystem &rows, const ContactProblem &problem);
  bool solve(const ModelEvaluation &at, const RowSystem &rows, const ContactProblem &problem, double *acceleration);
  [[nodiscard]] double accuracy() const;
  bool chooseColumns();
  void listRows(const RowSystem &rows);
  bool readRows(const ModelEvaluation &at, const RowSystem &rows);
  void findSets(const RowSystem &rows, const ContactRows &problem);
  void listFrictions(int normals, const ContactRows &problem);
  bool assignEquations();
  bool joinSets();
  bool joinSet(int s);
  bool listActive(const RowSystem &rows, const ContactRows &problem, const ContactMode &mode);
  void expand(const ContactProblem &problem);
  double contradiction(const ModelEvaluation &at, const RowSystem &rows, int row, int set, const double *acceleration) const;
  void compareEqual(const ModelEvaluation &at, const RowSystem &rows, const double *acceleration);

  std::vector<int> active_, equations_;  // rows
  std::vector<Limited> limited_;
  std::vector<ForceLimit> saturated_;
  double forceError_ = 1e-9;
  int normals_ = 0;
  bool mayPress_ = false;
  SemiseparableSystem system_;
  SemiseparableSystem::Determinant begin_;
  bool isKnown_ = false;                        // what rows are equal, and the system's structure: from a point before
  std::vector<SemiseparableSystem::Row> rows_;  // of which none are equal
  std::vector<int> number_;                     // in rows_, of all rows
  std::vector<std::uint8_t> isAlone_;           // of active rows
  std::vector<Set> sets_;
  std::vector<Joined> joined_;
  std::vector<int> hostOf_, setPlace_;    // of sets: the one that they join, and their places when these have gone
  std::vector<int> setOf_, setOfNumber_;  // of active rows, and of rows_ (−1: none yet)
  std::vector<int> unknowns_;
  std::vector<SemiseparableSystem::Friction> frictions_;
  std::vector<double> force_, bias_, unknownForce_, forces_, rest_, shares_;
  Correction corrections_[2];
  MassSample sample_;
  std::vector<int> sampleColumns_, sampled_;  // that are wanted, and those that sample_ has
  bool samples_ = false;                      // sample_ is M at the last evaluation
  std::vector<int> chosen_, chosenNumbers_;
  std::vector<std::uint8_t> isChosen_;  // of rows_
  std::vector<double> change_;
};

}  // namespace tf::runtime
