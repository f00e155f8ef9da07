// Sweeps: matrices by loops over coloured directions (function.h).
#pragma once

#include "compiler/ir/function.h"

#include <span>
#include <vector>

namespace tf::ir {

// The seeds that each result depends on, ascending. One pass over what the results reach.
[[nodiscard]] std::vector<std::vector<int>> seedStructure(const Graph &graph, std::span<const NodeId> results, int seedCount);

// A colour (from 0) for each seed, such that no result depends on two seeds of one colour: greedy, in the order of the seeds.
[[nodiscard]] std::vector<int> colourSeeds(const std::vector<std::vector<int>> &structure, int seedCount);

// A loop instead of expressions for the entries ∂results/∂seeds: the expressions are many, and several times as large together as what is
// evaluated in one pass of the loop. `fewEntries`: so many entries that are not structural zeros may always be written out.
[[nodiscard]] bool isSweepSmaller(const Graph &graph, std::span<const NodeId> results, int seedCount, std::size_t fewEntries);

// The matrix ∂results/∂seeds [results × seeds, row-major] as numbers.
[[nodiscard]] std::vector<double> evaluateMatrix(const Graph &graph, std::span<const NodeId> results, int seedCount,
                                                 const std::function<double(Symbol)> &value);

// Where a row of a matrix is stored. Unselected rows are left untouched.
struct MatrixRow {
  int buffer = 0, position = 0;
  int group = -1;
};

enum class SweepOver : std::uint8_t {
  Columns,  // J s: result r is row r, seed s column s
  Rows,     // Jᵀ s: seed s is row s, result r column r
};

// Gives the function the sweep that computes the rows; all their structural zeros are cleared.
void addSweep(Function &function, std::span<const NodeId> results, const std::vector<std::vector<int>> &structure, int seedCount,
              SweepOver over, std::span<const MatrixRow> rows);

}  // namespace tf::ir
