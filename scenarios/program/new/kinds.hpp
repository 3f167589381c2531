#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// The kinds of scenes that the command `hapbench new` can write.
namespace hapbench {

/// A kind of scene, such as a drag over a mesh.
struct StartKind {
  std::string name, summary;
  std::string source;  ///< kind of the source file: "mesh", "shell" or "stroke"; empty: no source file
  bool is_source_optional;
  Json scene;  ///< the fields that do not depend on the source
};

inline constexpr double kStartStep = 0.0005;  ///< time step of the scenes [s]

/// Returns the kinds of scenarios/library/starts.json, in the order in which they are listed. Throws InputError
/// if the file is missing.
const std::vector<StartKind>& start_kinds();
/// Returns the kind of this name. Throws InputError for an unknown name.
const StartKind& kind_named(const std::string& name);

}  // namespace hapbench
