#include "scenarios/batch/table_description.hpp"

#include <exception>
#include <nlohmann/json.hpp>

#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

}  // namespace

fs::path description_file(fs::path table) {
  return table.replace_extension(".json");
}

Json description_of(const fs::path& file) {
  Json about = with_file(file, [&] { return read_json(file); });
  if (!about.contains("definition")) fail_in_file(file, "is not the description of a sweep");
  return about;
}

std::string definition_in(const fs::path& about) {
  try {
    return description_of(about)["definition"].get<std::string>();
  } catch (const std::exception&) {
    return "";
  }
}

}  // namespace hapbench
