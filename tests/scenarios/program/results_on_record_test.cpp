#include <gtest/gtest.h>

#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/recorded_hashes.hpp"

/// What the commands besides `run` write, and what every algorithm makes of scenes of every kind, against the record;
/// the bundled scenarios' own results are compared in bundled_scenarios_test.cpp.
namespace hapbench::results_on_record_test {
namespace {

TEST(ResultsOnRecord, AreThoseOfEveryCommandAndAlgorithm) {
  const std::vector<std::vector<std::string>> commands = {
      {"compare", "peg_in_hole_2d_shaped_stiffness"},
      {"compare", "springs_limited_shaped_stiffness"},
      {"compare", "parallel_faces"},
      {"compare", "rotate_in_hole_proxy", "--set", "time={\"step_s\":0.0005,\"steps\":600}", "--set",
       "rendering.reduction={}"},
      {"compare", "task1_flat_binary", "--set", "time={\"step_s\":0.0005,\"steps\":600}", "--set", "record.energy=true",
       "--set", "record.contacts=true", "--set", "record.stiffness_tensor=true"},
      {"compare", "rotational_peg_in_hole_original_averaging", "--set", "time={\"step_s\":0.0005,\"steps\":600}",
       "--set", "hand.trials=1"},
      {"sweep", "peg_in_hole_2d_shaped_stiffness", "--vary", "rendering.stiffness_N_per_m=1e3:1e5:4:log", "--vary",
       "rendering.algorithm=mean,proxy", "--vary", "integrator.type=leapfrog,rk4,implicit_midpoint"},
      {"stability", "single_spring"},
      {"stability", "--map", "all", "--size", "3"},
      {"stability", "--map", "time_step", "--algorithms", "shaped_stiffness", "--integrators", "all", "--size", "3"},
      {"stability", "--stress", "--count", "3000"},
      {"stability", "peg_in_hole_2d_shaped_stiffness", "--search", "--evaluations", "8"},
  };
  const test::TemporaryDirectory directory;
  std::map<std::string, std::string> hashes;
  for (const std::vector<std::string>& command : commands) {
    std::string name = "command:";
    for (const std::string& word : command) name += " " + word;
    std::vector<std::string> arguments = command;
    const auto out = directory / std::to_string(hashes.size());
    arguments.insert(arguments.end(), {"--out", out.string(), "--quiet"});
    const test::ProgramRun run = test::hapbench(arguments);
    // 3: a run that diverges, as summation does in places.
    EXPECT_TRUE(run.status == 0 || run.status == 3) << name << ": " << run.err;
    hashes[name] = test::hash_of_results(out);
  }
  for (const char* what : {"scenario", "schema", "stability"}) {
    hashes[std::string("command: describe ") + what] =
        hash_text(hash_of(test::hapbench({"describe", what, "--json"}).out));
  }
  test::expect_recorded("command:", hashes);
}

}  // namespace
}  // namespace hapbench::results_on_record_test
