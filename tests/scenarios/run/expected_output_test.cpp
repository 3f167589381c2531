#include "scenarios/run/expected_output.hpp"

#include <gtest/gtest.h>

#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"

namespace hapbench::expected_output_test {
namespace {

LoadedScenario springs(const char* record, int steps = 2000) {
  Json json = Json::parse(
      R"({"environment": {"type": "springs", "groups": [{"direction": [1, 2, 3], "count": 1}, {"direction": [1, 0, 0], "count": 2}]},
                              "initial": {"position_m": [0.001, 0.002, 0.0005]}})");
  json["time"] = {{"step_s", 0.0005}, {"steps", steps}};
  json["record"] = Json::parse(record);
  return read_scenario(json, ".");
}

TEST(ExpectedOutput, IsWithinAFactorOfTwoOfWhatIsWritten) {
  for (const char* record :
       {R"({"trajectory": true})", R"({"trajectory": true, "every": 3})", R"({"trajectory": false, "energy": true})",
        R"({"trajectory": false, "stiffness_tensor": true})",
        R"({"trajectory": false, "ratio_iterations": [0, 1, 3]})"}) {
    const test::TemporaryDirectory directory;
    const LoadedScenario loaded = springs(record);
    run_scenario(loaded, directory.path(), false);
    double written = 0.0;
    for (const auto& entry : std::filesystem::directory_iterator(directory.path())) {
      if (entry.path().extension() == ".csv") written += static_cast<double>(entry.file_size());
    }
    const double expected = expected_output_bytes(loaded.scenario);
    EXPECT_LT(expected, 2.0 * written) << record;
    EXPECT_GT(expected, 0.5 * written) << record;
  }
}

TEST(ExpectedOutput, CountsEveryTrialAndNothingThatIsNotRecorded) {
  EXPECT_EQ(expected_output_bytes(springs(R"({"trajectory": false})").scenario), 0.0);
  LoadedScenario loaded = springs(R"({"trajectory": true})");
  const double one = expected_output_bytes(loaded.scenario);
  loaded.scenario.hand = TrackingHandFields{{}, {Subject{}, Subject{}}, 3};
  EXPECT_EQ(expected_output_bytes(loaded.scenario), 6.0 * one);
}

}  // namespace
}  // namespace hapbench::expected_output_test
