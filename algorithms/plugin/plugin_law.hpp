#pragma once

#include <cstdint>
#include <string>

#include "algorithms/plugin/hapbench_plugin.h"
#include "algorithms/registry.hpp"

namespace hapbench {

/// The entry of the table for a law behind the C interface, from the file `origin`. The plugin must outlive it. Throws
/// std::invalid_argument for a plugin whose functions or documentation are missing.
AlgorithmEntry plugin_entry(const HapbenchPlugin& plugin, AlgorithmOrigin origin);

/// Faults of laws from outside, over all threads.
struct PluginFaults {
  std::uint64_t count = 0;
  std::string first;  ///< text of the first
};
/// The faults since the last call.
PluginFaults take_plugin_faults();

}  // namespace hapbench
