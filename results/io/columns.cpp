#include "results/io/columns.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace hapbench {
namespace {

using nlohmann::ordered_json;

/// Appends a plain value. Strings, integers, booleans and null are written as nlohmann::json does; bytes that are
/// not UTF-8 become U+FFFD.
void write_plain(std::string& out, const ordered_json& value) {
  if (!value.is_number_float()) {
    out += value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  } else if (const double number = value.get<double>(); std::isfinite(number)) {
    out += NumberText(number);
  } else {
    out += "null";
  }
}

/// Appends a value. `indent`: number of spaces in front of the line on which the value starts.
void write(std::string& out, const ordered_json& value, std::size_t indent) {
  if (!value.is_structured() || value.empty()) return write_plain(out, value);
  const bool is_object = value.is_object();
  const auto is_plain = [](const ordered_json& item) { return item.is_primitive(); };
  const bool one_line = !is_object && std::all_of(value.begin(), value.end(), is_plain);
  const std::string end_of_line = one_line ? "" : "\n" + std::string(indent, ' ');
  // Write the items of the object or array, separated by commas. Each item gets a line, except in an array of plain
  // values.
  out += is_object ? '{' : '[';
  const char* separator = "";
  for (const auto& [key, item] : value.items()) {
    out += separator;
    if (!one_line) out += end_of_line + "  ";
    if (is_object) {
      write_plain(out, key);
      out += ": ";
    }
    write(out, item, indent + 2);
    separator = one_line ? ", " : ",";
  }
  out += end_of_line;
  out += is_object ? '}' : ']';
}

/// Returns columns or metrics as a JSON array of names, units and meanings.
template <class Entries>
ordered_json entries_json(const Entries& entries) {
  ordered_json json = ordered_json::array();
  for (const auto& entry : entries) {
    json.push_back({{"name", entry.name}, {"unit", entry.unit}, {"meaning", entry.meaning}});
  }
  return json;
}

}  // namespace

std::string json_text(const ordered_json& value) {
  std::string out;
  write(out, value, 0);
  out += '\n';
  return out;
}

ordered_json cell_json(const Cell& cell) {
  return std::visit(
      [](const auto& held) -> ordered_json {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::monostate>)
          return nullptr;
        else
          return held;
      },
      cell);
}

std::string cell_text(const Cell& cell) {
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return std::to_string(*count);
  if (const auto* number = std::get_if<double>(&cell)) return std::string(NumberText(*number));
  if (const auto* flag = std::get_if<bool>(&cell)) return *flag ? "true" : "false";
  const auto* text = std::get_if<std::string>(&cell);
  return text != nullptr ? *text : "";
}

const Metric* find_metric(const MetricList& list, std::string_view name) {
  const auto metric = std::ranges::find(list, name, &Metric::name);
  return metric != list.end() ? &*metric : nullptr;
}

Cell value_of(const MetricList& list, std::string_view name) {
  const Metric* metric = find_metric(list, name);
  return metric != nullptr ? metric->value : Cell();
}

std::optional<double> number_of(const Cell& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
  const auto* real = std::get_if<double>(&value);
  return real != nullptr ? std::optional(*real) : std::nullopt;
}

std::optional<double> Metric::tolerance() const {
  const auto number = number_of(value);
  return if_any(number && bounded, relative * std::abs(number.value_or(0.0)) + absolute);
}

bool resembles_formula(std::string_view text) {
  const std::size_t start = text.find_first_not_of('\'');
  if (start == std::string_view::npos || std::string_view("=+-@\t\r").find(text[start]) == std::string_view::npos)
    return false;
  if (start > 0) return true;
  // Numbers such as -1e-05 or +3 are no formulas, and neither is a single dash.
  const std::string_view digits = text.substr(text[0] == '+' ? 1 : 0);
  double number = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool is_number = end == digits.data() + digits.size() && error != std::errc::invalid_argument;
  return !is_number && text != "-";
}

std::string csv_cell(std::string_view text) {
  const std::string cell = (resembles_formula(text) ? "'" : "") + std::string(text);
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

ordered_json columns_json(std::span<const ResultTable> tables, const MetricList& metrics) {
  ordered_json json = {{"summary.json", entries_json(metrics)}};
  for (const ResultTable& table : tables) json[table.file] = entries_json(table.columns);
  return json;
}

}  // namespace hapbench
