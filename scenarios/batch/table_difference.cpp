#include "scenarios/batch/table_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/input/csv_reader.hpp"
#include "scenarios/input/number_table.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A column that both tables have.
struct SharedColumn {
  std::size_t in_a = 0, in_b = 0;
  double magnitude = 0.0;  ///< the largest so far
  ColumnDifference difference = {};
  bool differs = false;
};

std::optional<std::size_t> place_of(std::string_view name, const Words& columns) {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - columns.begin()));
}

std::vector<SharedColumn> shared_columns(const Words& a, const Words& b, TableDifference& difference) {
  std::vector<SharedColumn> shared;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto other = place_of(a[i], b);
    if (!other) {
      difference.only_in_a.emplace_back(a[i]);
      continue;
    }
    shared.push_back({i, *other});
    shared.back().difference.column = a[i];
  }
  for (const std::string_view name : b) {
    if (!place_of(name, a)) difference.only_in_b.emplace_back(name);
  }
  return shared;
}

void compare_cells(std::string_view a, std::string_view b, std::size_t row, SharedColumn& column,
                   TableDifference& difference) {
  const auto number_a = finite_number(a), number_b = finite_number(b);
  for (const auto& number : {number_a, number_b}) {
    if (number) column.magnitude = std::max(column.magnitude, std::abs(*number));
  }
  if (a == b) return;
  if (!difference.first) {
    difference.first = {row, column.difference.column, std::string(a), std::string(b)};
  }
  const double size = number_a && number_b ? std::abs(*number_a - *number_b) : kInfinity;
  if (!column.differs || size > column.difference.largest) {
    column.difference.largest = size;
    column.difference.row = row;
  }
  column.differs = true;
}

}  // namespace

CellDifference cell_difference(std::string a, std::string b) {
  const auto number_a = finite_number(a), number_b = finite_number(b);
  CellDifference difference{std::move(a), std::move(b), kInfinity, kInfinity};
  if (!number_a || !number_b) return difference;
  difference.largest = std::abs(*number_a - *number_b);
  const double magnitude = std::max(std::abs(*number_a), std::abs(*number_b));
  difference.relative = magnitude > 0.0 ? difference.largest / magnitude : 0.0;
  return difference;
}

bool TableDifference::is_beyond(double tolerance) const {
  if (rows_a != rows_b) return true;
  if (tolerance == 0.0) return !columns.empty();
  return std::any_of(columns.begin(), columns.end(), [tolerance](const ColumnDifference& column) {
    return column.column != "state_hash" && !(column.relative <= tolerance);
  });
}

TableDifference compare_tables(const fs::path& a, const fs::path& b) {
  const std::string text_a = read_named_file(a), text_b = read_named_file(b);
  CsvReader rows_a{LineReader(text_a), a}, rows_b{LineReader(text_b), b};
  TableDifference difference;
  std::vector<SharedColumn> columns = shared_columns(rows_a.columns(), rows_b.columns(), difference);
  bool more_a = rows_a.next(), more_b = rows_b.next();
  for (; more_a && more_b; more_a = rows_a.next(), more_b = rows_b.next()) {
    const std::size_t row = difference.rows_a;
    for (SharedColumn& column : columns) {
      compare_cells(rows_a.cells()[column.in_a], rows_b.cells()[column.in_b], row, column, difference);
    }
    ++difference.rows_a;
    ++difference.rows_b;
  }
  for (; more_a; more_a = rows_a.next()) ++difference.rows_a;
  for (; more_b; more_b = rows_b.next()) ++difference.rows_b;
  for (SharedColumn& column : columns) {
    if (!column.differs) continue;
    ColumnDifference& d = column.difference;
    d.relative = column.magnitude > 0.0 || std::isinf(d.largest) ? d.largest / column.magnitude : 0.0;
    difference.columns.push_back(d);
  }
  return difference;
}

}  // namespace hapbench
