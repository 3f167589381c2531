// `run`, `limit` and `tune` must compute the same linear limit of K. This must also hold in two special cases: for laws
// without weights, where the slope of the contact force over the displacement is not K times the stiffness ratio, and
// with a hand of type `impedance`, whose force is computed at the samples of the device.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench {
namespace {

using test::hapbench;

/// Returns the scenario of a tool that a hand presses on a plane. The force of the hand is computed at the samples of
/// the device.
Json pressed(const std::string& law, const char* device, const char* tip) {
  Json scene = Json::parse(R"({
    "time": {"step_s": 0.0005, "duration_s": 1.5},
    "environment": {"type": "plane", "size_m": 0.0066, "spacing_m": 0.00021},
    "hand": {"type": "impedance", "stiffness_N_per_m": 100, "damping_N_s_per_m": 2,
             "target": {"x_m": 0, "y_m": 0, "z_m": -0.003}},
    "device": {"type": "impedance", "coulomb_N": 0, "encoder_step_m": 0},
    "rendering": {"stiffness_N_per_m": 1000, "damping_ratio": 0}})");
  scene["tool"] = {{"diameter_m", 0.003}, {"length_m", 0.05}, {"tip", tip}};
  scene["device"]["preset"] = device;
  scene["rendering"]["algorithm"] = law;
  return scene;
}

class LinearLimitOfCommands : public testing::Test {
 protected:
  /// Returns the linear limit that `limit` reports [N/m]; empty if it reports none.
  std::optional<double> limit_of(const std::string& scene) const {
    const auto limit = hapbench({"limit", scene, "--resolution", "0.05", "--out", folder_ / "limit", "--json"}).json();
    const Json& linear = limit["limits"][0]["linear_limit"];
    return linear.is_number() ? std::optional(linear.get<double>()) : std::nullopt;
  }
  /// Returns K divided by the linear limit, as the rule `edge` in the diagnosis of `run` reports it at K [N/m]; empty
  /// if the rule finds nothing.
  std::optional<double> limit_ratio_at(const std::string& scene, double K) const {
    const auto run = hapbench(
        {"run", scene, "--set", fmt::format("rendering.stiffness_N_per_m={}", K), "--out", folder_ / "run", "--json"});
    const Json results = run.json();
    for (const Json& found : results[0]["diagnosis"])
      if (found["rule"] == "edge") return found["value"].get<double>();
    return std::nullopt;
  }
  test::TemporaryDirectory folder_;
};

TEST_F(LinearLimitOfCommands, IsOneInRunAndLimit) {
  std::size_t compared = 0;
  for (const char* law : {"static_coupling", "shaped_stiffness", "highest_depth"})
    for (const char* device : {"touch", "omega.3"})
      for (const char* tip : {"round", "flat"}) {
        const std::string scene = folder_ / "scene.json";
        test::write_plainly(scene, pressed(law, device, tip).dump());
        const auto linear = limit_of(scene);
        if (!linear) continue;
        for (const double factor : {1.2, 1.6}) {
          const auto ratio = limit_ratio_at(scene, factor * *linear);
          if (!ratio) continue;  // the run does not vibrate
          // Both commands compute the limit to 1e-7 from derivatives with an error of 1e-7. The tolerance is larger for
          // two reasons: a nonlinear contact has a slightly different slope at each equilibrium, and the value of
          // `edge` is printed with six digits.
          EXPECT_NEAR(*ratio, factor, 1e-4 * factor) << law << " " << device << " " << tip;
          ++compared;
        }
      }
  EXPECT_GE(compared, 6u);
}

TEST_F(LinearLimitOfCommands, IsBeyondTheMarginOfWhatTuneRecommends) {
  for (const char* law : {"static_coupling", "shaped_stiffness"}) {
    const std::string scene = folder_ / "scene.json";
    test::write_plainly(scene, pressed(law, "omega.3", "round").dump());
    const Json tune = hapbench({"tune", scene, "--out", folder_ / "tune", "--family", "hands", "--json"}).json();
    if (!tune["scenario"].is_string()) continue;
    const auto linear = limit_of(tune["scenario"].get<std::string>());
    ASSERT_TRUE(linear) << law;
    EXPECT_GE(*linear, 2.0 * tune["algorithms"][0]["stiffness_N_per_m"].get<double>()) << law;
  }
}

}  // namespace
}  // namespace hapbench
