// The symmetric positive definite mass matrix: M = Pᵀ L Δ Lᵀ P, L unit lower triangular, Δ diagonal, P a permutation.
//
// Which entries may differ from zero is known when the matrix is made; the unknowns fall into blocks that do not move one another (bodies
// apart), and within a block are eliminated in the order whose envelope is smallest: their own, the reverse one or that of minimum degree.
// Of branches from a common base, numbered outwards, elimination from the tips (Featherstone, Rigid Body Dynamics Algorithms, 2008, section
// 6.5) fills nothing. Small blocks take code for their size, large ones whose envelope is nearly full the dense kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tf::runtime {

class MassMatrix {
public:
  // Blocks up to this size have code of their own; their rows of L lie densely, one after the other.
  static constexpr int fixedSize = 6;

  // Entries below the diagonal that may differ from zero: columns[rows[i]] … columns[rows[i + 1] − 1] of row i, ascending. Null: all.
  explicit MassMatrix(int size, const std::int32_t *rows = nullptr, const std::int32_t *columns = nullptr);

  [[nodiscard]] int size() const { return size_; }
  // Factorises M [n × n, row-major, symmetric]. False if it is not positive definite (or not finite).
  bool factorise(const double *mass);
  // x = M⁻¹ b; x and b may be the same.
  void solve(const double *b, double *x) const;
  // Row (from 0) of the last pivot that failed.
  [[nodiscard]] int failedRow() const { return failedRow_; }

  // The two halves of a solution, in places: rows in the order of elimination, block after block.
  struct Block {
    int begin = 0, end = 0;
  };
  [[nodiscard]] const std::vector<Block> &blocks() const { return blocks_; }
  // The block of row i of M.
  [[nodiscard]] int blockOf(int row) const { return blockOf_[row]; }
  // z = L⁻¹ P b and scaled = Δ⁻¹ z on the places of one block. Returns the first place whose z is not zero, or the block's end.
  int forward(int block, const double *b, double *z, double *scaled) const;
  // The same on all places.
  void forward(const double *b, double *z, double *scaled) const;
  // Row of M of a place, and 1/Δ there.
  [[nodiscard]] int rowAt(int place) const { return rows_[place]; }
  [[nodiscard]] double inverseAt(int place) const { return inverse_[place]; }
  // Blocks whose first halves are best found for many rows together.
  [[nodiscard]] bool isLarge(int block) const { return blocks_[block].end - blocks_[block].begin > fixedSize; }
  // Z = L⁻¹ Z in the places of a large block, of `stride` columns (dense_kernels.h).
  void forwardPanel(int block, int stride, double *panel) const;
  // x += Pᵀ L⁻ᵀ y, all blocks; y is overwritten.
  void addBackward(double *y, double *x) const;

private:
  struct Pattern;
  void order(const Pattern &pattern);
  void addBlock(const Pattern &pattern, std::vector<int> rows);
  bool factoriseEnvelope(const Block &block, const double *mass);
  bool factoriseFull(std::size_t number, const double *mass);
  void forwardEnvelope(const Block &block, int from, double *x) const;
  void backward(double *y) const;
  [[nodiscard]] bool hasDiagonalFactor() const;
  [[nodiscard]] double *rowOf(int place) { return factor_.data() + start_[place]; }
  [[nodiscard]] const double *rowOf(int place) const { return factor_.data() + start_[place]; }

  int size_;
  bool inOrder_ = true;      // places are rows
  bool isDiagonal_ = false;  // L of the last factorisation is the unit matrix, places are rows
  std::vector<Block> blocks_;
  std::vector<int> rows_;                 // of places
  std::vector<int> blockOf_;              // of rows
  std::vector<int> first_;                // place of the first entry of each row of L
  std::vector<std::ptrdiff_t> start_;     // where each row of L begins in factor_; its entry of place k is at start + k
  std::vector<double> factor_, inverse_;  // L, and 1 / Δ of places
  std::vector<int> strides_;              // of blocks: from row to row of L where all of them are kept, else 0
  std::vector<double> unscaled_;          // rows of L Δ
  mutable std::vector<double> work_;
  int failedRow_ = -1;
};

}  // namespace tf::runtime
