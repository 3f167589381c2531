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

/// The values in result files (columns of CSV files and metrics of summary.json): names, units, meanings and text
/// format.
namespace hapbench {

/// A number as text, without allocation. Integers are decimal. Doubles are the shortest decimal that reads back as
/// the same double ("0.1", "1e-05", "-0", "inf", "nan").
class NumberText {
 public:
  template <class Number>
  requires std::same_as<Number, double> || std::integral<Number>
  explicit NumberText(Number value) noexcept {
    size_ =
        static_cast<std::size_t>(std::to_chars(text_.data(), text_.data() + text_.size(), value).ptr - text_.data());
  }

  operator std::string_view() const noexcept { return {text_.data(), size_}; }  // NOLINT: implicit on purpose

 private:
  std::array<char, 32> text_{};  // a double has at most 24 characters, a 64-bit integer at most 20
  std::size_t size_ = 0;
};

/// Returns the text of a JSON result file: keys in insertion order, two spaces of indentation, arrays of plain
/// values on one line, a final newline. Doubles are written like NumberText, but null if they are not finite.
std::string json_text(const nlohmann::ordered_json& value);

/// A column of a result file, as documented by its header, `hapbench describe` and columns.json.
struct Column {
  const char* name;
  const char* unit;     ///< "1" for pure numbers and counts, empty for text
  const char* meaning;  ///< one sentence without a full stop; f is f_render, the rendered force on the tool
};

/// Documentation of one CSV result file.
struct ResultTable {
  const char* file;   ///< file name
  std::string holds;  ///< content of a line, and when the file is written
  std::vector<Column> columns;
};

/// Returns the header line without a line break: the column names, separated by commas.
inline std::string header_of(std::span<const Column> columns) {
  std::string header;
  for (const Column& column : columns) header += (header.empty() ? "" : ",") + std::string(column.name);
  return header;
}

/// First two columns of most tables that have one line for each recorded time step.
inline constexpr Column kStepColumn = {"step", "1", "row number k, from 0"};
inline constexpr Column kTimeColumn = {"time_s", "s", "time of the row, k times the time step"};

/// One cell of a table: empty (an empty cell in CSV, null in JSON), a count, a number, a boolean, or text.
using Cell = std::variant<std::monostate, std::uint64_t, double, bool, std::string>;

/// Converts a number, count, boolean or text, or an optional of these, to a cell. An empty optional gives an empty
/// cell; a Cell is returned unchanged.
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
/// Returns the text of a cell in a CSV file before quoting (see csv_cell); an empty string for an empty cell.
std::string cell_text(const Cell& cell);

/// Direction in which a metric improves if all other metrics stay equal: `less` means that a smaller value is better.
/// Metrics such as a position, a count or a work have the value `none`.
enum class Better { none, less, more };

/// A named number that describes a run.
struct Metric {
  std::string name;     ///< dots separate sections, as in "gentle.rows"
  const char* unit;     ///< "1" for pure numbers and counts
  const char* meaning;  ///< definition and computation; ||.|| is the Euclidean norm, f is f_render
  Cell value;           ///< a count or a number; empty if it does not exist (such as a ratio without contact)
  Better better = Better::none;
  double relative = 0.0, absolute = 0.0;  ///< arguments of `within`, which define the tolerance
  bool bounded = false;                   ///< true if `within` has set a tolerance
  /// True if the metric varies smoothly with the time step: a quantity at a fixed time, or a sum or mean over a fixed
  /// interval of time. False if the metric is an extreme, a percentile or a count, or depends on the times at which
  /// contacts begin or end.
  bool smooth = false;
  bool either_sign = false;  ///< true if the value can be negative
  /// If only every n-th step counts (TimeFields::stride): estimated range of the value over all n choices of the first
  /// counted step [unit of the value]. 0 if every step counts, or if the metric has no value.
  double sampling_spread = 0.0;

  /// Marks a metric as `smooth`.
  Metric& varies_smoothly() {
    smooth = true;
    return *this;
  }
  /// Marks a metric as `either_sign`.
  Metric& has_either_sign() {
    either_sign = true;
    return *this;
  }

  /// Sets the tolerance: `relative` |value| + `absolute` [unit of the value].
  Metric& within(double relative_part, double absolute_part) {
    bounded = true;
    relative = relative_part;
    absolute = absolute_part;
    return *this;
  }
  /// Returns the tolerance: the value may be wrong by at most this error [unit of the value]. Empty if `within` was not
  /// called or there is no value.
  std::optional<double> tolerance() const;
};

/// Returns a number as the value of a metric; empty if it is not finite.
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

/// Returns `value` if `exists` is true, otherwise nothing.
template <class Value>
std::optional<Value> if_any(bool exists, Value value) {
  return exists ? std::optional(value) : std::nullopt;
}

/// The metrics of a run or of one section, in the order of summary.json.
using MetricList = std::vector<Metric>;

/// Returns the metric with this name; null if no metric has this name.
const Metric* find_metric(const MetricList& list, std::string_view name);
/// Returns the value of the metric with this name; an empty cell if no metric has this name.
Cell value_of(const MetricList& list, std::string_view name);
/// Returns a count or a number as a double; empty for all other cells.
std::optional<double> number_of(const Cell& value);
/// Returns the value of the metric with this name as a double; empty if no metric has this name, or if its value is not
/// a number.
inline std::optional<double> number_of(const MetricList& list, std::string_view name) {
  return number_of(value_of(list, name));
}

/// Returns true if a spreadsheet may take a cell with this text for a formula. Such a text begins with "=", "+", "-",
/// "@", a tab or a carriage return, possibly after apostrophes. Numbers and a single "-" are no formulas.
bool resembles_formula(std::string_view text);

/// Returns the text of a cell in a CSV file. A text that resembles a formula gets an apostrophe in front, which
/// spreadsheets take for the mark of a text; csv_cells() and the Python package remove the apostrophe. A text with a
/// comma, quote or line break is in double quotes.
std::string csv_cell(std::string_view text);

/// Returns columns.json, which documents the results for other programs: name, unit and meaning of each column of
/// each table and of each metric of summary.json.
nlohmann::ordered_json columns_json(std::span<const ResultTable> tables, const MetricList& metrics);

}  // namespace hapbench
