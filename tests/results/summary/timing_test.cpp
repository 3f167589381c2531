#include "results/summary/timing.hpp"

#include <gtest/gtest.h>

namespace hapbench::timing_test {
namespace {

const Provenance kProvenance = {.version = "1.2.3",
                                .commit = "abc",
                                .compiler = "GNU 12.2.0",
                                .build_type = "Release",
                                .flags = "-O3",
                                .cpu = "Some CPU"};

TEST(Timing, TextHoldsMeanTimeInstructionSetAndCpu) {
  EXPECT_EQ(timing_text({.shell = 0.25,
                         .loop = 0.5,
                         .steps = 2000,
                         .latency = {},
                         .step_p50 = 0.5e-6,
                         .step_p99 = 2e-6,
                         .preemptions = 3},
                        {.march = "native", .widest = "avx2", .simd = true}, kProvenance),
            R"({
  "shell_s": 0.25,
  "loop_s": 0.5,
  "steps": 2000,
  "step_mean_s": 0.00025,
  "step_p50_s": 5e-07,
  "step_p99_s": 2e-06,
  "step_latency": null,
  "preemptions": 3,
  "build": {
    "march": "native",
    "instruction_set": "avx2",
    "simd": true,
    "compiler": "GNU 12.2.0",
    "build_type": "Release",
    "flags": "-O3",
    "commit": "abc"
  },
  "cpu": "Some CPU"
}
)");
}

TEST(Timing, HoldsTheLatencyOfTimedSteps) {
  RunTiming timing;
  timing.latency = step_latency(std::vector<std::uint64_t>{1000, 2000}, 20);
  EXPECT_EQ(timing_json(timing, {}, kProvenance)["step_latency"], step_latency_json(*timing.latency));
}

TEST(Timing, OfNoStepsHasNoMean) {
  EXPECT_TRUE(timing_json({}, {}, kProvenance)["step_mean_s"].is_null());
}

// On x86-64 every build has at least SSE2.
#if defined(__x86_64__)
TEST(InstructionSet, IsKnownOnX86) {
  EXPECT_NE(instruction_set().widest, "none known");
}
#endif

}  // namespace
}  // namespace hapbench::timing_test
