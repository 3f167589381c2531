#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "scenarios/import/import_options.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::string text_in(const Json& json, const std::string& field) {
  if (!json.is_string()) throw InputError(fmt::format("{}: got {}; allowed: a text", field, shown(json)));
  return json.get<std::string>();
}

double number_in(const Json& json, const std::string& field) {
  if (!json.is_number()) throw InputError(fmt::format("{}: got {}; allowed: a number", field, shown(json)));
  return json.get<double>();
}

bool boolean_in(const Json& json, const std::string& field) {
  if (!json.is_boolean()) throw InputError(fmt::format("{}: got {}; allowed: true, false", field, shown(json)));
  return json.get<bool>();
}

/// A text, a column's number or a list of them.
std::vector<std::string> columns_in(const Json& json, const std::string& field) {
  const auto word = [&field](const Json& one) {
    return one.is_number_unsigned() ? std::to_string(one.get<std::uint64_t>()) : text_in(one, field);
  };
  std::vector<std::string> words;
  if (!json.is_array()) return {word(json)};
  for (const Json& one : json) words.push_back(word(one));
  return words;
}

Vec3 vector_in(const Json& json, const std::string& field) {
  if (!json.is_array() || json.size() != 3)
    throw InputError(fmt::format("{}: got {}; allowed: three numbers", field, shown(json)));
  return {number_in(json[0], field), number_in(json[1], field), number_in(json[2], field)};
}

const Json& object_in(const Json& json, const std::string& field) {
  if (!json.is_object()) throw InputError(fmt::format("{}: got {}; allowed: an object", field, shown(json)));
  return json;
}

struct PresetField {
  const char* name;
  void (*set)(ImportOptions& options, const Json& value, const std::string& name);
};

const PresetField kFields[] = {
    {"description", [](ImportOptions&, const Json& value, const std::string& name) { text_in(value, name); }},
    {"format",
     [](ImportOptions& o, const Json& value, const std::string& name) { set_format(o, text_in(value, name)); }},
    {"floats",
     [](ImportOptions& o, const Json& value, const std::string& name) { o.floats = boolean_in(value, name); }},
    {"columns",
     [](ImportOptions& o, const Json& value, const std::string& name) {
       for (const auto& [quantity, columns] : object_in(value, name).items()) {
         set_column(o, quantity, columns_in(columns, name + ": " + quantity));
         if (quantity == "orientation" || quantity == "force") o.optional_columns.push_back(quantity);
       }
     }},
    {"sample_rate_Hz",
     [](ImportOptions& o, const Json& value, const std::string& name) { o.sample_rate = number_in(value, name); }},
    {"scale",
     [](ImportOptions& o, const Json& value, const std::string& name) {
       for (const auto& [quantity, factor] : object_in(value, name).items())
         set_scale(o, quantity, number_in(factor, name + ": " + quantity));
     }},
    {"orientation",
     [](ImportOptions& o, const Json& value, const std::string& name) { set_orientation(o, text_in(value, name)); }},
    {"tip_axis",
     [](ImportOptions& o, const Json& value, const std::string& name) { o.tip_axis = vector_in(value, name); }},
    {"frame",
     [](ImportOptions& o, const Json& value, const std::string& name) { set_frame(o, columns_in(value, name)); }},
    {"force_by_tool",
     [](ImportOptions& o, const Json& value, const std::string& name) { o.force_by_tool = boolean_in(value, name); }},
};

Json preset_in(const fs::path& file) {
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    return object_in(json, "a preset");
  } catch (const InputError& error) {
    fail_in_file(file, error.problem());
  }
}

}  // namespace

std::vector<ImportPreset> import_presets() {
  std::vector<ImportPreset> presets;
  for (const auto& entry : fs::directory_iterator(installed_folder("scenarios/import/presets"))) {
    if (entry.path().extension() != ".json") continue;
    const Json json = preset_in(entry.path());
    presets.push_back({entry.path().stem().string(), json.value("description", ""), entry.path()});
  }
  std::sort(presets.begin(), presets.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return presets;
}

void apply_preset(ImportOptions& options, const std::string& name_or_file) {
  fs::path file = name_or_file;
  if (!name_or_file.ends_with(".json")) {
    std::vector<std::string> names;
    for (const ImportPreset& preset : import_presets()) {
      names.push_back(preset.name);
      if (preset.name == name_or_file) file = preset.file;
    }
    require_valid_name("preset: got", name_or_file, names);
  }
  std::vector<std::string> valid;
  for (const PresetField& field : kFields) valid.emplace_back(field.name);
  const Json preset = preset_in(file);
  try {
    for (const auto& [name, value] : preset.items()) {
      require_valid_name("got field", name, valid);
      const std::string& wanted = name;
      std::find_if(std::begin(kFields), std::end(kFields), [&wanted](const PresetField& field) {
        return field.name == wanted;
      })->set(options, value, name);
    }
  } catch (const InputError& error) {
    fail_in_file(file, error.what());
  }
}

}  // namespace hapbench
