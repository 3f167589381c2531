#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// The field that names another scenario.
inline constexpr const char* kExtends = "extends";

/// A scenario file as it stands.
struct ScenarioLayer {
  std::filesystem::path file;
  Json json;
};

/// Reads a scenario file and, over and over, the one that its field "extends" names: a file, relative to the one that
/// names it, or else a bundled scenario. Returns the fields of all, each merged over those it extends, and appends the
/// files to `layers`, the given one first.
///
/// Objects merge field by field; anything else replaces what it meets, null too, which is a value like any other. An
/// object replaces one of another "type", whose fields would mean nothing in it. Of two fields that exclude each other
/// ("steps" and "duration_s") the one that is given drives out the other. "name" and "expect" are not taken over: they
/// say what that one scenario is called and shows. A relative path in a field "file" stays relative to its own file.
///
/// Throws InputError that begins with the file at fault; a chain that comes back to itself is refused.
Json read_extended(const std::filesystem::path& file, std::vector<ScenarioLayer>& layers);

/// Takes out of `object` the field that the one of this name excludes.
void drop_alternative(Json& object, std::string_view field);

}  // namespace hapbench
