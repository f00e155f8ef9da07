// Dense storage of the contact solvers: shapes change from mode to mode, memory is kept, so that nothing is allocated after the largest
// shape has been seen.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstring>
#include <vector>

namespace tf::runtime {

// Column-major rows × cols matrix. `resize` leaves the entries undefined.
class DenseMatrix {
public:
  DenseMatrix() = default;
  DenseMatrix(int rows, int cols) { setZero(rows, cols); }

  void resize(int rows, int cols) {
    rows_ = rows;
    cols_ = cols;
    data_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  }
  void setZero(int rows, int cols) {
    resize(rows, cols);
    data_.assign(data_.size(), 0.0);
  }

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  [[nodiscard]] double *data() { return data_.data(); }
  [[nodiscard]] const double *data() const { return data_.data(); }
  [[nodiscard]] double *column(int j) { return data_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(rows_); }
  [[nodiscard]] const double *column(int j) const { return data_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(rows_); }
  double &operator()(int i, int j) { return column(j)[i]; }
  double operator()(int i, int j) const { return column(j)[i]; }

  [[nodiscard]] Eigen::Map<Eigen::MatrixXd> map() { return {data_.data(), rows_, cols_}; }
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> map() const { return {data_.data(), rows_, cols_}; }

private:
  std::vector<double> data_;
  int rows_ = 0, cols_ = 0;
};

// Columns i and j of a symmetric matrix are the same to the bit, and so is what they have on the diagonal.
[[nodiscard]] inline bool areEqualColumns(const DenseMatrix &symmetric, int i, int j) {
  return symmetric(i, i) == symmetric(j, j) &&
         std::memcmp(symmetric.column(i), symmetric.column(j), sizeof(double) * static_cast<std::size_t>(symmetric.rows())) == 0;
}

}  // namespace tf::runtime
