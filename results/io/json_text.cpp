#include "results/io/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hapbench {
namespace {

using nlohmann::ordered_json;

/// Writes strings, integers, booleans and null as nlohmann does; bytes that are not UTF-8 become U+FFFD.
void write_plain(std::string& out, const ordered_json& value) {
  if (!value.is_number_float()) {
    out += value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  } else if (const double number = value.get<double>(); std::isfinite(number)) {
    out += NumberText(number);
  } else {
    out += "null";
  }
}

void write(std::string& out, const ordered_json& value, std::size_t indent) {
  if (!value.is_structured() || value.empty()) return write_plain(out, value);
  const bool is_object = value.is_object();
  const auto is_plain = [](const ordered_json& item) { return item.is_primitive(); };
  const bool one_line = !is_object && std::all_of(value.begin(), value.end(), is_plain);
  const std::string end_of_line = one_line ? "" : "\n" + std::string(indent, ' ');
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

}  // namespace

std::string json_text(const ordered_json& value) {
  std::string out;
  write(out, value, 0);
  out += '\n';
  return out;
}

}  // namespace hapbench
