#pragma once

#include <string>

namespace hapbench {

/// The version and the commit of the program in a line; as JSON also what it was built from and what a version
/// promises.
std::string version_text(bool as_json);

}  // namespace hapbench
