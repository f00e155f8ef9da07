#include "compiler/ir/sweep.h"

#include "compiler/ir/operations.h"
#include "compiler/ir/subgraph.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <utility>

namespace tf::ir {

namespace {

constexpr std::size_t wordBits = 64;
// Expressions must be so many times as large as one pass of a loop: some of what is written out simplifies away, and operations of a loop
// are on vectors and are executed in every pass.
constexpr std::size_t loopWeight = 4;

// Rows of bits.
class BitTable {
public:
  BitTable(std::size_t rows, std::size_t columns) : words_((columns + wordBits - 1) / wordBits), bits_(rows * words_, 0) {}

  void set(std::size_t row, std::size_t column) { bits_[row * words_ + column / wordBits] |= std::uint64_t{1} << column % wordBits; }
  void unite(std::size_t row, std::size_t other) {
    for (std::size_t w = 0; w < words_; ++w)
      bits_[row * words_ + w] |= bits_[other * words_ + w];
  }
  [[nodiscard]] std::span<const std::uint64_t> row(std::size_t row) const { return std::span(bits_).subspan(row * words_, words_); }
  [[nodiscard]] std::size_t count() const { return countOf(bits_); }
  [[nodiscard]] std::size_t count(std::size_t row) const { return countOf(this->row(row)); }

private:
  static std::size_t countOf(std::span<const std::uint64_t> words) {
    return std::accumulate(words.begin(), words.end(), std::size_t{0},
                           [](std::size_t sum, std::uint64_t word) { return sum + static_cast<std::size_t>(std::popcount(word)); });
  }

  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

std::vector<int> indicesOf(std::span<const std::uint64_t> bits) {
  std::vector<int> indices;
  for (std::size_t w = 0; w < bits.size(); ++w)
    for (std::uint64_t rest = bits[w]; rest != 0; rest &= rest - 1)
      indices.push_back(static_cast<int>(w * wordBits) + std::countr_zero(rest));
  return indices;
}

// The structure by seeds: the results that depend on each, ascending.
std::vector<std::vector<int>> transpose(const std::vector<std::vector<int>> &structure, int seedCount) {
  std::vector<std::vector<int>> results(static_cast<std::size_t>(seedCount));
  for (std::size_t r = 0; r < structure.size(); ++r)
    for (const int seed : structure[r])
      results[static_cast<std::size_t>(seed)].push_back(static_cast<int>(r));
  return results;
}

// Adds an entry to the last run if it continues it.
void append(std::vector<Sweep::Run> &runs, int result, int buffer, int position, int group) {
  if (!runs.empty()) {
    Sweep::Run &last = runs.back();
    const int stride = last.count == 1 ? position - last.position : last.stride;
    if (last.buffer == buffer && last.group == group && last.first + last.count == result && stride > 0 &&
        last.position + last.count * stride == position) {
      last.stride = stride;
      ++last.count;
      return;
    }
  }
  runs.push_back({result, 1, buffer, position, 1, group});
}

// Clears the rows that have structural zeros; rows that follow one another at once.
void clearRows(Function &function, std::span<const MatrixRow> rows, const std::vector<int> &entries, int length) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (entries[k] == length)
      continue;
    if (!function.clears.empty()) {
      Clear &last = function.clears.back();
      if (last.buffer == rows[k].buffer && last.group == rows[k].group && last.position + last.length == rows[k].position) {
        last.length += length;
        continue;
      }
    }
    function.clears.push_back({rows[k].buffer, rows[k].position, length, rows[k].group});
  }
}

// The seeds that each node depends on.
BitTable seedsOfNodes(const Graph &graph, const Subgraph &reached, int seedCount) {
  BitTable depends(static_cast<std::size_t>(reached.size()), static_cast<std::size_t>(seedCount));
  for (std::size_t k = 0; k < static_cast<std::size_t>(reached.size()); ++k) {
    const Node &node = graph[reached.node(static_cast<int>(k))];
    if (node.op == Op::Symbol && node.symbol.kind == SymbolKind::Seed)
      depends.set(k, static_cast<std::size_t>(node.symbol.index));
    for (int j = 0; j < node.arity; ++j)
      depends.unite(k, static_cast<std::size_t>(reached.position(node.operands[j])));
  }
  return depends;
}

}  // namespace

std::vector<std::vector<int>> seedStructure(const Graph &graph, std::span<const NodeId> results, int seedCount) {
  const Subgraph reached(graph, results);
  const BitTable depends = seedsOfNodes(graph, reached, seedCount);
  std::vector<std::vector<int>> structure;
  structure.reserve(results.size());
  for (const NodeId result : results)
    structure.push_back(indicesOf(depends.row(static_cast<std::size_t>(reached.position(result)))));
  return structure;
}

std::vector<int> colourSeeds(const std::vector<std::vector<int>> &structure, int seedCount) {
  const std::vector<std::vector<int>> resultsOf = transpose(structure, seedCount);
  BitTable used(structure.size(), static_cast<std::size_t>(seedCount));  // colours of the seeds of each result
  std::vector<int> colours(static_cast<std::size_t>(seedCount), 0);
  std::vector<std::uint64_t> taken((static_cast<std::size_t>(seedCount) + wordBits - 1) / wordBits);
  for (std::size_t seed = 0; seed < colours.size(); ++seed) {
    std::ranges::fill(taken, std::uint64_t{0});
    for (const int result : resultsOf[seed]) {
      const auto row = used.row(static_cast<std::size_t>(result));
      for (std::size_t w = 0; w < taken.size(); ++w)
        taken[w] |= row[w];
    }
    std::size_t word = 0;
    while (taken[word] == ~std::uint64_t{0})
      ++word;
    const std::size_t colour = word * wordBits + static_cast<std::size_t>(std::countr_one(taken[word]));
    colours[seed] = static_cast<int>(colour);
    for (const int result : resultsOf[seed])
      used.set(static_cast<std::size_t>(result), colour);
  }
  return colours;
}

// Written out, a node that depends on seeds is there once for each of them.
bool isSweepSmaller(const Graph &graph, std::span<const NodeId> results, int seedCount, std::size_t fewEntries) {
  const Subgraph reached(graph, results);
  const BitTable seeds = seedsOfNodes(graph, reached, seedCount);
  const std::size_t entries = std::accumulate(results.begin(), results.end(), std::size_t{0}, [&](std::size_t sum, NodeId result) {
    return sum + seeds.count(static_cast<std::size_t>(reached.position(result)));
  });
  return entries > fewEntries && seeds.count() > loopWeight * static_cast<std::size_t>(reached.size());
}

std::vector<double> evaluateMatrix(const Graph &graph, std::span<const NodeId> results, int seedCount,
                                   const std::function<double(Symbol)> &value) {
  const Subgraph reached(graph, results);
  const auto positionOf = [&](NodeId id) { return static_cast<std::size_t>(reached.position(id)); };
  std::vector<double> values(static_cast<std::size_t>(reached.size()));
  std::vector<char> isSwept(values.size(), 0);
  std::vector<std::array<std::size_t, 3>> operands(values.size());
  const auto apply = [&](std::size_t k) {
    const Node &node = graph[reached.node(static_cast<int>(k))];
    const double arguments[3] = {values[operands[k][0]], values[operands[k][1]], values[operands[k][2]]};
    values[k] = applyNode(graph, node, std::span(arguments, node.arity));
  };
  std::vector<std::size_t> swept;  // operations that depend on seeds
  std::vector<std::pair<std::size_t, int>> seeds;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Node &node = graph[reached.node(static_cast<int>(k))];
    for (int j = 0; j < node.arity; ++j) {
      operands[k][static_cast<std::size_t>(j)] = positionOf(node.operands[j]);
      isSwept[k] |= isSwept[operands[k][static_cast<std::size_t>(j)]];
    }
    if (node.op == Op::Symbol && node.symbol.kind == SymbolKind::Seed) {
      isSwept[k] = 1;
      seeds.emplace_back(k, node.symbol.index);
    } else if (isSwept[k] != 0) {
      swept.push_back(k);
    } else if (node.arity > 0) {
      apply(k);
    } else {
      values[k] = node.op == Op::Constant ? node.value : value(node.symbol);
    }
  }
  std::vector<double> matrix(results.size() * static_cast<std::size_t>(seedCount), 0);
  for (const auto &[place, seed] : seeds) {
    values[place] = 1;
    std::ranges::for_each(swept, apply);
    for (std::size_t r = 0; r < results.size(); ++r)
      if (const std::size_t k = positionOf(results[r]); isSwept[k] != 0)
        matrix[r * static_cast<std::size_t>(seedCount) + static_cast<std::size_t>(seed)] = values[k];
    values[place] = 0;
  }
  return matrix;
}

void addSweep(Function &function, std::span<const NodeId> results, const std::vector<std::vector<int>> &structure, int seedCount,
              SweepOver over, std::span<const MatrixRow> rows) {
  assert(!function.sweep && rows.size() == (over == SweepOver::Columns ? results.size() : static_cast<std::size_t>(seedCount)));
  Sweep sweep;
  sweep.seedCount = seedCount;
  for (std::size_t r = 0; r < results.size(); ++r)
    sweep.results.push_back({results[r], over == SweepOver::Columns ? rows[r].group : -1});
  const std::vector<std::vector<int>> resultsOf = transpose(structure, seedCount);
  const std::vector<int> colours = colourSeeds(structure, seedCount);
  for (std::size_t seed = 0; seed < colours.size(); ++seed) {
    if (resultsOf[seed].empty())
      continue;
    sweep.colours.resize(std::max(sweep.colours.size(), static_cast<std::size_t>(colours[seed]) + 1));
    Sweep::Colour &colour = sweep.colours[static_cast<std::size_t>(colours[seed])];
    colour.seeds.push_back(static_cast<int>(seed));
    for (const int r : resultsOf[seed]) {
      const MatrixRow &row = rows[over == SweepOver::Columns ? static_cast<std::size_t>(r) : seed];
      if (over == SweepOver::Columns)
        append(colour.runs, r, row.buffer, row.position + static_cast<int>(seed), -1);
      else
        append(colour.runs, r, row.buffer, row.position + r, row.group);
    }
  }
  std::vector<int> entries(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k)
    entries[k] = static_cast<int>(over == SweepOver::Columns ? structure[k].size() : resultsOf[k].size());
  clearRows(function, rows, entries, over == SweepOver::Columns ? seedCount : static_cast<int>(results.size()));
  function.sweep = std::move(sweep);
}

}  // namespace tf::ir
