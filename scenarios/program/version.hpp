#pragma once

#include <string>

namespace hapbench {

/// Returns a line with the version and the commit of the program. `as_json`: returns a JSON object that also
/// has the build settings and the compatibility guarantees.
std::string version_text(bool as_json);

}  // namespace hapbench
