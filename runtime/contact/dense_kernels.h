// Kernels of dense linear algebra for tens to hundreds of rows. Every sum has a fixed order: the code for wider vector registers, which the
// loader picks where the processor has them, gives the same bits.
#pragma once

#include <cstddef>

namespace tf::runtime {

// Rows of panels begin at multiples of this number of entries.
constexpr int panelLanes = 8;

[[nodiscard]] constexpr int paddedToLanes(int count) { return (count + panelLanes - 1) / panelLanes * panelLanes; }

// Σ a_k b_k
[[nodiscard]] double denseDot(const double *a, const double *b, int count);

// y_i −= Σ_k A_ik x_k of a row-major matrix
void subtractProduct(const double *matrix, int rows, int columns, const double *x, double *y);
// y [rows] += factor Σ_k x_k column_k of a column-major matrix, factor 1 or −1; one product after the other.
void addManyColumns(const double *matrix, int rows, int columns, double factor, const double *x, double *y);
inline void addColumns(const double *matrix, int rows, int columns, double factor, const double *x, double *y) {
  if (rows >= panelLanes)
    return addManyColumns(matrix, rows, columns, factor, x, y);
  for (int k = 0; k < columns; ++k, matrix += rows)
    for (int i = 0; i < rows; ++i)
      y[i] += factor * x[k] * matrix[i];
}
// y += factor · row; returns Σ row_k x_k, x and y apart from each other.
double dotAndAdd(const double *row, const double *x, double factor, double *y, int count);

// y = x; returns Σ x_k weight_k.
double copyAndWeigh(const double *x, const double *weight, int count, double *y);
// The first place from `begin` on whose value is within `accepted` of x; `end`: none.
int firstWithin(const double *values, int begin, int end, double x, double accepted);
// The largest |x_k − y_k| and |x_k|.
struct Difference {
  double largest = 0, ofFirst = 0;
};
Difference largestDifference(const double *x, const double *y, int count);

// rest_k = row_k scale_k − Σ_i factors_i parts_i,k, and the largest magnitudes of rest_k and of row_k scale_k.
struct RowRest {
  double largest = 0, ofRow = 0;
};
RowRest subtractRows(const double *row, const double *scale, const double *factors, const double *const *parts, int partCount, int count,
                     double *rest);

// Householder's QR decomposition of a matrix with so many rows, column-major, column after column: the first j columns hold v_k, from row k
// on, of the reflections H_k = I − scale_k v_k v_kᵀ, scale_k = 2/‖v_k‖², and R above. Column j becomes H_{j−1} … H_0 times itself and then,
// from row j on, v_j; R_jj in `diagonal`, and cross_j = v_{j−1}ᵀ v_j for odd j: reflections are applied in pairs. False, with no v_j and
// R_jj made, where the column's part outside the span of those before is not longer than `dependence`. H_0 … H_{from−1} have been applied
// to the column already, `from` even.
bool reflectColumn(double *matrix, int rows, int j, double dependence, double *scale, double *cross, double &diagonal, int from = 0);
// The reflectionWidth columns from j on, j even, become H_{j−1} … H_0 times themselves.
constexpr int reflectionWidth = 4;
void reflectColumns(double *matrix, int rows, int j, const double *scale, const double *cross);
// x [rows] ← H_0 … H_{columns−1} x
void applyReflections(const double *matrix, int rows, int columns, const double *scale, const double *cross, double *x);

// Panels: `depth` rows of `stride` entries, a multiple of panelLanes. D = Zᵀ S, symmetric; `product` stride × stride, of which entries
// (i, j) with j ≤ i are right.
void multiplyPanels(const double *z, const double *s, int depth, int stride, double *product);
// Rows i of Z, begin ≤ i < end, less Σ L_ik row k, first[i] ≤ k < i, one after the other; L_ik at factor + start[i] + k. Z begins with row
// `begin`.
void forwardPanel(const double *factor, const std::ptrdiff_t *start, const int *first, int begin, int end, int stride, double *z);

// x ← L⁻ᵀ x for rows begin ≤ i < end of a unit lower triangular matrix, stored as for forwardPanel.
void backwardRows(const double *factor, const std::ptrdiff_t *start, const int *first, int begin, int end, double *x);

// M = L Δ Lᵀ of the lower triangle of a size × size matrix with rows `stride` (a multiple of panelLanes) apart: L below the diagonal, 1/Δ
// in `inverse`, what is right of the diagonal is overwritten. `work`: 4 × stride. Returns the first row whose pivot is not above `singular`
// times its diagonal entry, or −1.
int factoriseDense(double *matrix, int size, int stride, double singular, double *inverse, double *work);

// A = L Lᵀ of a symmetric positive semidefinite matrix (lower triangle, column-major) with unit diagonal, rows and columns permuted by
// `order`, which is permuted along: the largest pivot first, until none is larger than `dependence`. Returns their number.
int factoriseSemidefinite(double *matrix, int size, double dependence, int *order);

// P A = L U of a size × size matrix, column-major: U, and L below the diagonal, with row k exchanged for row pivot[k] ≥ k, one after the
// other. False where a pivot's magnitude is not above `singular`, or not finite.
bool factoriseLu(double *matrix, int size, double singular, int *pivot);
// b ← A⁻¹ b of such factors.
void solveLu(const double *matrix, int size, const int *pivot, double *b);

}  // namespace tf::runtime
