#include "results/summary/timing.hpp"

#include <nlohmann/json.hpp>

#include "results/io/json_text.hpp"

namespace hapbench {

using nlohmann::ordered_json;

ordered_json timing_json(const RunTiming& timing, const InstructionSet& instructions, const Provenance& provenance) {
  ordered_json mean = nullptr;
  if (timing.steps > 0) mean = timing.loop / static_cast<double>(timing.steps);
  return {{"shell_s", timing.shell},
          {"loop_s", timing.loop},
          {"steps", timing.steps},
          {"step_mean_s", mean},
          {"step_p50_s", timing.step_p50 ? ordered_json(*timing.step_p50) : ordered_json(nullptr)},
          {"step_p99_s", timing.step_p99 ? ordered_json(*timing.step_p99) : ordered_json(nullptr)},
          {"step_latency", timing.latency ? step_latency_json(*timing.latency) : ordered_json(nullptr)},
          {"preemptions", timing.preemptions},
          {"build",
           {{"march", instructions.march},
            {"instruction_set", instructions.widest},
            {"simd", instructions.simd},
            {"compiler", provenance.compiler},
            {"build_type", provenance.build_type},
            {"flags", provenance.flags},
            {"commit", provenance.commit}}},
          {"cpu", provenance.cpu}};
}

std::string timing_text(const RunTiming& timing, const InstructionSet& instructions, const Provenance& provenance) {
  return json_text(timing_json(timing, instructions, provenance));
}

}  // namespace hapbench
