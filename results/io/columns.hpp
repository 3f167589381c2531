#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// What the numbers of result files are called and mean: columns of CSV files and metrics of summary.json.
namespace hapbench {

/// A column of a result file: what its header, `hapbench describe` and columns.json say of it.
struct Column {
  const char* name;
  const char* unit;     ///< "1" for pure numbers and counts, empty for text
  const char* meaning;  ///< in a sentence without its full stop; f is f_render, the force on the tool
};

/// A kind of CSV file among the results.
struct ResultTable {
  const char* file;   ///< its name
  const char* holds;  ///< what a line is, and when it is written
  std::span<const Column> columns;
};

/// The header line without its end: the names, separated by commas.
inline std::string header_of(std::span<const Column> columns) {
  std::string header;
  for (const Column& column : columns) header += (header.empty() ? "" : ",") + std::string(column.name);
  return header;
}

/// The first columns of most tables of rows.
inline constexpr Column kStepColumn = {"step", "1", "row number k, from 0"};
inline constexpr Column kTimeColumn = {"time_s", "s", "time of the row, k times the time step"};

/// What stands in one cell of a table: nothing, a count, a number, true or false, or text. In CSV the first is empty,
/// in JSON null.
using Cell = std::variant<std::monostate, std::uint64_t, double, bool, std::string>;

/// A cell of a value that need not exist.
template <class Value>
Cell cell_if(const std::optional<Value>& value) {
  return value ? Cell(*value) : Cell();
}

/// A column of a table whose rows are of type `Row`, and its cell in such a row. A constant array of them describes the
/// whole table: CSV file (write_csv in csv_writer.hpp), JSON (rows_json) and documentation (columns_of).
template <class Row>
struct Field {
  Column column;
  Cell (*cell)(const Row& row);
};

template <class Row, std::size_t size>
std::vector<Column> columns_of(const Field<Row> (&fields)[size]) {
  std::vector<Column> columns;
  for (const Field<Row>& field : fields) columns.push_back(field.column);
  return columns;
}

/// A cell as a JSON value.
nlohmann::ordered_json json_of(const Cell& cell);

/// A row as a JSON object with the columns' names as keys.
template <class Row, std::size_t size>
nlohmann::ordered_json row_json(const Field<Row> (&fields)[size], const Row& row);

/// A number of a run, by name. It has no value when it does not exist (a ratio without contact) or is not finite.
struct Metric {
  using Value = std::variant<std::monostate, std::uint64_t, double>;  ///< none, a count, a number

  std::string name;  ///< dots lead into sections, as in "gentle.rows"
  const char* unit = "";
  const char* meaning = "";  ///< what it says and how it is computed; ||.|| is the Euclidean norm, f is f_render
  Value value = {};

  static Metric number(const char* name, const char* unit, const char* meaning, std::optional<double> value);
  static Metric number_if(bool exists, const char* name, const char* unit, const char* meaning, double value);
  static Metric count(const char* name, const char* meaning, std::optional<std::uint64_t> value);
};

/// The metrics of a run or of a part of it. Each subject's header has a function `metric_list`, the one place that
/// names and documents its metrics; the names do not depend on the run, except that each target place has its own.
using MetricList = std::vector<Metric>;

/// The value of that name; none when there is no such metric.
Metric::Value value_of(const MetricList& list, std::string_view name);
/// A value as a number.
std::optional<double> number_of(const Metric::Value& value);
/// A value as a cell of a CSV file; empty for none.
std::string cell_text(const Metric::Value& value);

/// Appends `more`, its names in the section, if one is given.
void append(MetricList& list, std::string_view section, const MetricList& more);

/// columns.json, for other programs: for each file its columns, and for summary.json its metrics, each with name, unit
/// and meaning.
nlohmann::ordered_json columns_json(std::span<const ResultTable> tables, const MetricList& metrics);
/// Those of one file, and the metrics alone.
nlohmann::ordered_json columns_json(std::span<const Column> columns);
nlohmann::ordered_json columns_json(const MetricList& metrics);

}  // namespace hapbench
