#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// What `new` can start.
namespace hapbench {

/// A kind of scene to start from.
struct StartKind {
  std::string name, summary;
  std::string source;  ///< what it is made from: "mesh", "shell" or "stroke"; empty for nothing
  bool is_source_optional;
  Json scene;  ///< with what does not depend on the source
};

inline constexpr double kStartStep = 0.0005;  ///< time step of the scenes [s]

/// The kinds of scenarios/library/starts.json, in the order in which they are shown. Throws InputError without that
/// file.
const std::vector<StartKind>& start_kinds();
/// Throws InputError for an unknown name.
const StartKind& kind_named(const std::string& name);

}  // namespace hapbench
