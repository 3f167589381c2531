#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

/// The numbers in result files, columns of CSV files and metrics of summary.json: names, units, meanings and texts.
namespace hapbench {

/// A number as text, without allocation: integers in decimal, doubles as the shortest decimal that reads back as the
/// same double ("0.1", "1e-05", "-0", "inf", "nan").
class NumberText {
 public:
  template <class Number>
  requires std::same_as<Number, double> || std::integral<Number>
  explicit NumberText(Number value) noexcept {
    size_ =
        static_cast<std::size_t>(std::to_chars(text_.data(), text_.data() + text_.size(), value).ptr - text_.data());
  }

  operator std::string_view() const noexcept { return {text_.data(), size_}; }  // NOLINT: it is a text

 private:
  std::array<char, 32> text_{};  // the longest shortest double has 24 characters, an integer of 64 bits 20
  std::size_t size_ = 0;
};

/// The text of a result file: keys in their order, two spaces of indentation, arrays of plain values on one line, a
/// final newline. Doubles are as in NumberText, but null where they are not finite.
std::string json_text(const nlohmann::ordered_json& value);

/// A column of a result file: what its header, `hapbench describe` and columns.json say of it.
struct Column {
  const char* name;
  const char* unit;     ///< "1" for pure numbers and counts, empty for text
  const char* meaning;  ///< in a sentence without its full stop; f is f_render, the force on the tool
};

/// A kind of CSV file among the results.
struct ResultTable {
  const char* file;   ///< its name
  std::string holds;  ///< what a line is, and when it is written
  std::vector<Column> columns;
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

/// One cell of a table: nothing (empty in CSV, null in JSON), a count, a number, true or false, or text.
using Cell = std::variant<std::monostate, std::uint64_t, double, bool, std::string>;

/// The cell of a number, a count, a truth, a text, one of them that need not exist, or of what is a cell already.
template <class Value>
Cell cell_of(const Value& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? cell_of(*value) : Cell();
  } else if constexpr (std::is_convertible_v<Value, std::string_view>) {
    return std::string(std::string_view(value));
  } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
    return static_cast<std::uint64_t>(value);
  } else {
    return value;
  }
}

nlohmann::ordered_json cell_json(const Cell& cell);
/// A cell of a CSV file before it is quoted (csv_cell); empty for nothing.
std::string cell_text(const Cell& cell);

/// The direction in which a metric gets better, all else equal. Most have none: a position, a count, a work.
enum class Better { none, less, more };

/// A number of a run, by name.
struct Metric {
  std::string name;     ///< dots lead into sections, as in "gentle.rows"
  const char* unit;     ///< "1" for pure numbers and counts
  const char* meaning;  ///< what it says and how it is computed; ||.|| is the Euclidean norm, f is f_render
  Cell value;           ///< a count or a number; nothing where it does not exist (a ratio without contact)
  Better better = Better::none;
  double relative = 0.0, absolute = 0.0;  ///< parts of the tolerance, as `within` gives them
  bool bounded = false;                   ///< has a tolerance where it has a value

  /// Sets the tolerance: `relative` |value| + `absolute` [unit of the value].
  Metric& within(double relative_part, double absolute_part) {
    bounded = true;
    relative = relative_part;
    absolute = absolute_part;
    return *this;
  }
  /// How far the value may be off; empty if that is not known or there is no value.
  std::optional<double> tolerance() const;
};

/// The value of a metric: a number that is not finite is none.
inline Cell metric_value(std::unsigned_integral auto count) {
  return std::uint64_t{count};
}
inline Cell metric_value(double number) {
  return std::isfinite(number) ? Cell(number) : Cell();
}
template <class Given>
Cell metric_value(const std::optional<Given>& given) {
  return given ? metric_value(*given) : Cell();
}

/// A value that need not exist.
template <class Value>
std::optional<Value> if_any(bool exists, Value value) {
  return exists ? std::optional(value) : std::nullopt;
}

/// The metrics of a run or of a part of it, in the order of summary.json.
using MetricList = std::vector<Metric>;

/// The metric of that name; null when there is none.
const Metric* find_metric(const MetricList& list, std::string_view name);
/// The value of that name, if there is such a metric.
Cell value_of(const MetricList& list, std::string_view name);
/// A count or a number as a number.
std::optional<double> number_of(const Cell& value);
/// The value of that name as a number; empty without such a metric or without a value.
inline std::optional<double> number_of(const MetricList& list, std::string_view name) {
  return number_of(value_of(list, name));
}
/// A text as a cell of a CSV file: in quotes where it has a comma, a quote or an end of a line (RFC 4180).
std::string csv_cell(std::string_view text);

/// columns.json, for other programs: the columns of each file and the metrics of summary.json by name, unit, meaning.
nlohmann::ordered_json columns_json(std::span<const ResultTable> tables, const MetricList& metrics);

}  // namespace hapbench
