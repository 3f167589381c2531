#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Runs that go beyond every bound end as diverged, whichever part of the loop goes.
namespace hapbench::divergence_test {
namespace {

/// A hand whose damping is too much for the time step drives the handle, which is a body of its own, to infinity, while
/// the tool swings on.
TEST(Divergence, OfTheHandleEndsTheRun) {
  const Json scenario = Json::parse(R"({
    "time": {"step_s": 0.003, "steps": 2000},
    "environment": {"type": "plane"},
    "initial": {"position_m": [0, 0, 0]},
    "device": {"type": "admittance"},
    "hand": {"type": "impedance", "stiffness_N_per_m": 500, "damping_N_s_per_m": 50,
             "target": {"x_m": 0, "y_m": 0, "z_m": -0.001}}
  })");
  const RunReport run = run_scenario(read_scenario(scenario, "."), std::nullopt, false);
  EXPECT_EQ(run.summary.result.outcome, Outcome::diverges);
  const std::string quantity = run.summary.result.divergence.quantity;
  EXPECT_TRUE(quantity == "handle position" || quantity == "handle velocity" || quantity == "measured force")
      << quantity;
  EXPECT_GT(run.summary.result.divergence.magnitude, run.summary.result.divergence.bound);
}

}  // namespace
}  // namespace hapbench::divergence_test
