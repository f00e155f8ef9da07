#include "compiler/codegen/loop_tables.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <map>

namespace tf::codegen {

namespace {

// Columns that differ by a constant from one that is there already are not tabulated again.
class WholeColumns {
public:
  WholeSource add(std::vector<std::int64_t> column) {
    const std::int64_t first = column.front();
    for (std::int64_t &value : column)
      value -= first;
    if (std::ranges::all_of(column, [](std::int64_t value) { return value == 0; }))
      return {-1, first};
    const auto [known, isNew] = numberOf_.emplace(std::move(column), static_cast<int>(firsts_.size()));
    if (isNew)
      firsts_.push_back(first);
    return {known->second, first - firsts_[static_cast<std::size_t>(known->second)]};
  }

  void write(LoopTables &tables, std::size_t rows) const {
    const std::size_t columns = firsts_.size();
    tables.wholeColumns = static_cast<int>(columns);
    tables.wholeRows.resize(rows * columns);
    for (const auto &[differences, number] : numberOf_)
      for (std::size_t row = 0; row < rows; ++row)
        tables.wholeRows[row * columns + static_cast<std::size_t>(number)] =
            static_cast<std::int32_t>(firsts_[static_cast<std::size_t>(number)] + differences[row]);
  }

private:
  std::map<std::vector<std::int64_t>, int> numberOf_;  // by the differences from the first row
  std::vector<std::int64_t> firsts_;
};

// By their bits: 0 and −0 differ.
class RealColumns {
public:
  RealSource add(const std::vector<double> &column) {
    std::vector<std::uint64_t> bits;
    bits.reserve(column.size());
    for (const double value : column)
      bits.push_back(std::bit_cast<std::uint64_t>(value));
    if (std::ranges::all_of(bits, [&bits](std::uint64_t value) { return value == bits.front(); }))
      return {-1, column.front()};
    return {numberOf_.emplace(std::move(bits), static_cast<int>(numberOf_.size())).first->second, 0};
  }

  void write(LoopTables &tables, std::size_t rows) const {
    const std::size_t columns = numberOf_.size();
    tables.realColumns = static_cast<int>(columns);
    tables.realRows.resize(rows * columns);
    for (const auto &[bits, number] : numberOf_)
      for (std::size_t row = 0; row < rows; ++row)
        tables.realRows[row * columns + static_cast<std::size_t>(number)] = std::bit_cast<double>(bits[row]);
  }

private:
  std::map<std::vector<std::uint64_t>, int> numberOf_;
};

std::int64_t wholeAt(const Place &place, const Unit &unit, const ir::Graph &graph, const std::function<int(ir::NodeId)> &slotOf) {
  switch (place.kind) {
  case Place::Kind::Constant:
    break;
  case Place::Kind::Symbol:
    return graph[place.node].symbol.index;
  case Place::Kind::Slot:
    return slotOf(place.node);
  case Place::Kind::Position:
    return unit.steps[static_cast<std::size_t>(place.step)].position;
  case Place::Kind::Length:
    return unit.steps[static_cast<std::size_t>(place.step)].length;
  }
  return 0;
}

// Units from `row` on whose groups are among `width` from those of the first one on.
std::int64_t rowsWithin(std::span<const Unit> units, std::size_t row, int width) {
  const auto isWithin = [width](int group, int first) { return group >= first && group < first + width; };
  std::size_t end = row + 1;
  while (end < units.size() && isWithin(units[end].group, units[row].group) && isWithin(units[end].second, units[row].second))
    ++end;
  return static_cast<std::int64_t>(end - row);
}

}  // namespace

LoopTables tabulate(std::span<const Unit> units, const ir::Graph &graph, const ShapeContext &context,
                    const std::function<int(ir::NodeId)> &slotOf) {
  const std::size_t rows = units.size();
  std::vector<UnitShape> shapes;
  shapes.reserve(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    shapes.push_back(shapeOf(units[row], graph, context));
    assert(shapes[row].code == shapes.front().code);
  }
  LoopTables tables;
  tables.places = shapes.front().places;
  WholeColumns wholes;
  RealColumns reals;
  const auto whole = [&](const auto &valueOf) {
    std::vector<std::int64_t> column;
    column.reserve(rows);
    for (std::size_t row = 0; row < rows; ++row)
      column.push_back(valueOf(row));
    return wholes.add(std::move(column));
  };
  tables.group = whole([&](std::size_t row) { return units[row].group; });
  tables.second = whole([&](std::size_t row) { return units[row].second; });
  for (std::size_t w = 0; w < flagWidths.size() && units.front().group >= 0; ++w)
    tables.skips[w] = whole([&](std::size_t row) { return rowsWithin(units, row, flagWidths[w]); });
  for (std::size_t k = 0; k < tables.places.size(); ++k) {
    const bool isConstant = tables.places[k].kind == Place::Kind::Constant;
    tables.wholes.push_back(isConstant ? WholeSource{}
                                       : whole([&](std::size_t row) { return wholeAt(shapes[row].places[k], units[row], graph, slotOf); }));
    tables.reals.emplace_back();
    if (!isConstant)
      continue;
    std::vector<double> column;
    column.reserve(rows);
    for (std::size_t row = 0; row < rows; ++row)
      column.push_back(graph[shapes[row].places[k].node].value);
    tables.reals.back() = reals.add(column);
  }
  wholes.write(tables, rows);
  reals.write(tables, rows);
  return tables;
}

}  // namespace tf::codegen
