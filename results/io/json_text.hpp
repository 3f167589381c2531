#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hapbench {

/// The text of a result file: keys in their order, two spaces of indentation, arrays of plain values on one line, a
/// final newline. Doubles are the shortest decimals that read back the same (nlohmann's own writer is not always
/// shortest); those that are not finite, for which JSON has no word, become null.
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace hapbench
