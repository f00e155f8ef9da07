// The equations of motion of a mode, with its contact forces, of bodies that are linked one to the next:
//
//     M a − Σ_u F_uᵀ x_u = f,    J_u a = −c_u
//
// where J_u is the row of the unknown force x_u, and F_u the same row with the friction that it takes along. What lies beyond a joint moves
// with the joint: in the order of the coordinates, outwards, each row of J and of M's lower triangle is U·V_j with few vectors V_j of the
// columns j that it reaches (in the plane 2 of them with absolute angles, 3 with relative ones). With each force placed behind the last
// coordinate that its row reaches the whole matrix is semiseparable, and is factorised in O(n r²), n unknowns, r vectors (Vandebril, Van
// Barel, Mastronardi, Matrix Computations and Semiseparable Matrices I, 2008, chapter 4); the recursion is that of the articulated body
// inertia (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7), from the base outwards.
//
// The vectors are found from the numbers and checked against them, and solutions are refined with the matrices themselves: a system that is
// not of this kind is refused. They are a basis of the columns that are reached, chosen anew where these become fewer: near the base all
// motions of what lies beyond may be nearly parallel.
#pragma once

#include "runtime/integrate/mass_sample.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tf::runtime {

class SemiseparableSystem {
public:
  static constexpr int mostVectors = 6;
  static constexpr double rounding = 2e-15;

  // Unknown forces are refused of whose rows less than `dependence` is left by those before, in the metric of M⁻¹.
  explicit SemiseparableSystem(double dependence = 1e-12) : dependence_(dependence) {}

  // A row of J [n] with its last entry that may differ from zero before `end`.
  struct Row {
    const double *entries = nullptr;
    int end = 0;
  };
  // Friction that an unknown force takes along: `factor` times its own, along another row.
  struct Friction {
    int unknown = 0, row = 0;
    double factor = 0;
  };

  // Of M [size × size, row-major, symmetric; its unit times velocities' is that of momenta] with the rows; `unknowns` are numbers of rows,
  // `frictions` are those of all unknowns. All must exist while the system is solved. False: not of this kind, or singular.
  bool factorise(const double *mass, int size, std::span<const Row> rows, std::span<const int> unknowns,
                 std::span<const Friction> frictions);
  // The same at other numbers, of as many rows with the same ends: the vectors are those of the same rows. That the others are sums of
  // them, and that rows are zero behind their ends, is not checked here, it shows in what solve() leaves. False: see there.
  bool refactorise(const double *mass, std::span<const Row> rows);
  // The same where M is known by a sample, whose diagonal is found where it is not known yet. False: see there, or the sample lacks a
  // column that is needed; what it contradicts by more than `accuracy` is none of these matrices. It must exist while the system is solved.
  bool refactorise(MassSample &sample, std::span<const Row> rows, double accuracy);
  // The columns of M that the last factorisation was made from, beside the diagonal.
  [[nodiscard]] const std::vector<int> &columns() const { return columns_; }
  // 1/√M_jj of the numbers that were factorised first.
  [[nodiscard]] std::span<const double> scale() const { return scale_; }
  // Of what a solution leaves: all equations, or those of the rows alone, where the others have been seen to hold with these numbers.
  enum class Check : std::uint8_t { Everything, Rows };
  // `acceleration` [size] and `forces` [unknowns] for f = `force` [size] and c = `bias` [unknowns], in the units of the model. False: not
  // to the accuracy of the numbers; after refactorise(), that the vectors have to be found anew. Residuals up to `accuracy`, relative to
  // what they are made of, are left.
  bool solve(const double *force, const double *bias, double *acceleration, double *forces, double accuracy = rounding,
             Check check = Check::Everything);

  // Number of vectors.
  [[nodiscard]] int vectorCount() const { return count_; }

  // mantissa · 2^exponent
  struct Determinant {
    double mantissa = 1;
    int exponent = 0;
    void multiply(double factor);  // by one whose magnitude is far from those of the least and the largest numbers
    [[nodiscard]] double relativeTo(const Determinant &other) const;
  };
  // Of the matrix J_u M⁻¹ F_wᵀ of the unknowns: that of the whole matrix over that of M. Factorisations find it unless they are told not
  // to.
  [[nodiscard]] const Determinant &determinant() const { return determinant_; }
  void followDeterminant(bool follows) { followsDeterminant_ = follows; }

private:
  void replaceRows(std::span<const Row> rows);
  bool factoriseListed();
  bool factoriseVectors();
  [[nodiscard]] const double *massColumn(int column) const;
  void noteColumn(int column);
  bool findDiagonal(double accuracy);
  template <int R, int L> void multiplyBeside(const double *x, double *product) const;
  bool scaleColumns();
  bool findVectors();
  bool findVectorsAt(int end);
  template <int R> void readCoefficients(int last, int end);
  void listExpressed();
  void sortByEnd(std::size_t count);
  void dropColumns(int end);
  void turn(int k, int column, int end);
  void turnCoefficients(int k, double *coefficients) const;
  bool expressMass(int end);
  bool express(const double *row, int end, double *coefficients, double &size, std::uint8_t &adds);
  void keepColumn(int end);
  void order();
  void combine();
  template <int R> void moveOn(int number, double (&m)[R], double (&l)[R], double (&W)[R][R]) const;
  template <int R> bool eliminateAll();
  template <int R> void prepareSubstitution(std::size_t place, const double (&m)[R], const double (&l)[R]);
  template <int R> void substitute(const double *rightHandSide, double *solution) const;
  template <int R> void pass(int number, double (&W)[R][R]) const;
  template <int R> void turnForward(int number, double *x) const;
  template <int R> void turnBack(int number, double *x) const;
  void solveOnce(const double *rightHandSide, double *solution) const;
  void subtractMassProduct(const double *x, double *rest);
  double findResidual(const double *force, const double *bias, const double *acceleration, const double *forces, Check check);

  // The vectors are slots of this number, those not in use zero.
  [[nodiscard]] double *reduced(int k) { return reduced_.data() + static_cast<std::ptrdiff_t>(k) * stride_; }

  double dependence_;
  bool followsDeterminant_ = true;
  Determinant determinant_;
  const double *mass_ = nullptr;
  MassSample *sample_ = nullptr;  // instead of mass_
  std::vector<int> columns_;
  std::vector<double> weights_, products_;
  int size_ = 0, stride_ = 0, count_ = 0;
  std::span<const Row> rows_;
  std::span<const int> unknowns_;
  std::span<const Friction> frictions_;
  // Of columns: √M_jj of the numbers that were factorised first, 1/√M_jj, and M_jj as scaled by them.
  std::vector<double> root_, scale_, diagonal_;
  // The basis of the columns that are left, in reduced echelon form, of scaled columns; the columns of its pivots (−1: a slot that is not
  // in use); that of the columns before by it; and what takes one step of a change of the basis into that.
  std::vector<double> reduced_;
  int pivot_[mostVectors] = {};
  double change_[mostVectors][mostVectors] = {}, factor_[mostVectors] = {};
  bool isChanged_ = false;
  std::vector<double> vectors_;            // V_j in the basis of the columns up to j [mostVectors each]
  std::vector<int> transition_;            // of columns j: its number, of the basis up to j − 1 into that up to j; −1: none
  std::vector<double> transitions_;        // mostVectors² each
  std::vector<double> rest_;               // of a row
  std::vector<double> outer_, rowOuter_;   // U of rows of M (scaled) and of expressed rows [mostVectors each]
  std::vector<const double *> expressed_;  // rows of the unknowns, then of the frictions
  std::vector<double> rowSize_;            // of them: the largest scaled entry
  std::vector<std::uint8_t> adds_;         // rows of M, and of them: they are not sums of the vectors of those before
  std::vector<int> addEnds_;               // where they end, descending
  bool isKnown_ = false;                   // adds_ is that of numbers before
  std::vector<int> firstOfEnd_, byEnd_;    // of them, or of the unknowns alone, by their ends
  std::vector<int> order_;                 // of elimination: column j < n, or n + unknown
  std::vector<int> ends_;                  // of the expressed rows
  // In the order of elimination, count_ each: rows p and columns g of what is left, m and l of the factors over the pivots, and 1/pivot.
  std::vector<double> row_, column_, left_, right_, inverse_;
  // As well, count_² each: what takes the sums of a substitution over one unknown, forward S − m pᵀ/pivot and back Sᵀ − g lᵀ/pivot, S the
  // transition. An unknown's value waits for none of the values before, but for their sums.
  std::vector<double> forward_, back_;
  std::vector<double> residual_, correction_, rowForce_, rowProduct_;
};

}  // namespace tf::runtime
