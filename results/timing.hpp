#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "results/provenance.hpp"

namespace hapbench {

/// Wall time of the step loop, observers included.
struct RunTiming {
  double loop = 0.0;        ///< [s]
  std::uint64_t steps = 0;  ///< rows computed in that time
};

/// timing.json: apart from summary.json because no two runs take the same time. Names the build's instruction set and
/// the CPU, since times are comparable for the same ones only. The mean is null without steps.
nlohmann::ordered_json timing_json(const RunTiming& timing, const InstructionSet& instructions,
                                   const Provenance& provenance);
std::string timing_text(const RunTiming& timing, const InstructionSet& instructions, const Provenance& provenance);

}  // namespace hapbench
