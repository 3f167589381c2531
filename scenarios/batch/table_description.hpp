#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/input/json_file.hpp"

/// The JSON file next to a table, which describes the sweep. The files of the same sweep have the same "definition".
namespace hapbench {

/// Returns the path of the JSON file next to a table, such as sweep.json for sweep.csv.
std::filesystem::path description_file(std::filesystem::path table);

/// Reads the description in a JSON file. Throws InputError if the file cannot be read or has no definition.
Json description_of(const std::filesystem::path& file);

/// Returns the definition in a JSON file; an empty text if the file cannot be read or has no definition.
std::string definition_in(const std::filesystem::path& about);

}  // namespace hapbench
