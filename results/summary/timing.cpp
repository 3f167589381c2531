#include "results/summary/timing.hpp"

#include <nlohmann/json.hpp>

#include "results/io/json_text.hpp"

namespace hapbench {
namespace {

using nlohmann::ordered_json;

double seconds(double nanoseconds) {
  return nanoseconds / 1e9;  // the double nearest to the decimal, unlike multiplication by 1e-9
}

}  // namespace

ordered_json step_latency_json(const StepLatency& latency) {
  const auto if_any = [&latency](std::uint64_t ns) {
    return latency.steps > 0 ? ordered_json(seconds(static_cast<double>(ns))) : ordered_json(nullptr);
  };
  ordered_json json = {{"steps", latency.steps},
                       {"clock_overhead_s", seconds(static_cast<double>(latency.overhead))},
                       {"p50_s", if_any(latency.p50)},
                       {"p95_s", if_any(latency.p95)},
                       {"p99_s", if_any(latency.p99)},
                       {"p99_9_s", if_any(latency.p99_9)},
                       {"max_s", if_any(latency.max)},
                       {"deadline_misses", ordered_json::array()},
                       {"histogram", ordered_json::array()},
                       {"over_time_s", ordered_json::array()}};
  for (std::size_t i = 0; i < kStepDeadlines.size(); ++i) {
    json["deadline_misses"].push_back({{"deadline_s", kStepDeadlines[i]}, {"steps", latency.misses[i]}});
  }
  for (const StepLatency::Bin& bin : latency.histogram) {
    json["histogram"].push_back({{"from_s", seconds(static_cast<double>(bin.from))},
                                 {"to_s", seconds(static_cast<double>(bin.to))},
                                 {"steps", bin.steps}});
  }
  for (const std::uint64_t median : latency.over_time) {
    json["over_time_s"].push_back(seconds(static_cast<double>(median)));
  }
  return json;
}

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
