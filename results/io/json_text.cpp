#include "results/io/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hapbench {
namespace {

using nlohmann::ordered_json;

void write(std::string& out, const ordered_json& value, std::size_t indent);

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

void new_line(std::string& out, std::size_t indent) {
  out += '\n';
  out.append(indent, ' ');
}

void write_object(std::string& out, const ordered_json& object, std::size_t indent) {
  out += '{';
  const char* separator = "";
  for (const auto& [key, value] : object.items()) {
    out += separator;
    new_line(out, indent + 2);
    write_plain(out, key);
    out += ": ";
    write(out, value, indent + 2);
    separator = ",";
  }
  new_line(out, indent);
  out += '}';
}

void write_array(std::string& out, const ordered_json& array, std::size_t indent) {
  const bool one_line = std::all_of(array.begin(), array.end(), [](const auto& value) { return value.is_primitive(); });
  out += '[';
  const char* separator = "";
  for (const ordered_json& value : array) {
    out += separator;
    if (!one_line) new_line(out, indent + 2);
    write(out, value, indent + 2);
    separator = one_line ? ", " : ",";
  }
  if (!one_line) new_line(out, indent);
  out += ']';
}

void write(std::string& out, const ordered_json& value, std::size_t indent) {
  if (value.is_object() && !value.empty()) {
    write_object(out, value, indent);
  } else if (value.is_array() && !value.empty()) {
    write_array(out, value, indent);
  } else {
    write_plain(out, value);
  }
}

}  // namespace

std::string json_text(const ordered_json& value) {
  std::string out;
  write(out, value, 0);
  out += '\n';
  return out;
}

}  // namespace hapbench
