#pragma once

#include "algorithms/registry.hpp"

namespace hapbench {

/// The entry with copies of its texts, which it keeps alive. Throws std::invalid_argument for what `add_algorithm`
/// refuses, names that are taken aside.
AlgorithmEntry checked_copy(AlgorithmEntry entry);

}  // namespace hapbench
