#include "tests/bench/accuracy/accuracy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/loop/integrators/table.hpp"
#include "tests/scenarios/support/bundled.hpp"

/// Tests the errors that are shown beside the run times, against closed forms.
namespace hapbench::accuracy_test {
namespace {

using accuracy::Panel, accuracy::Setting, test::bundled;

/// Returns the settings of a panel whose names begin with `beginning`.
Panel those(const Panel& panel, const std::string& beginning) {
  Panel found;
  for (const Setting& setting : panel)
    if (setting.name.starts_with(beginning)) found.push_back(setting);
  EXPECT_FALSE(found.empty()) << beginning;
  return found;
}

double value(const Panel& panel, const std::string& beginning, const char* name) {
  return those(panel, beginning).front().errors()[name];
}

/// Returns the scenario of the drill in the hole, for half a rotation and with a coarser grid of the block.
Scenario drill() {
  return bundled("task2_rotate_signed_distance",
                 {"time.duration_s=3", "environment.grid_m=0.0002", "rendering.local_average=false"});
}

TEST(Integrators, ConvergeWithTheirOrdersToTheExactSolution) {
  const Panel panel = accuracy::integrators(bundled("springs_oscillation"));
  for (const IntegratorEntry* integrator : kIntegrators) {
    double step = NAN, error = NAN, order = NAN;
    for (const Setting& setting : those(panel, "integrators/" + std::string(integrator->info.name) + " ")) {
      const accuracy::Errors errors = setting.errors();
      // Stop at a hundred times the rounding error that rk4 reaches with the finest steps.
      if (errors["error_rms_m"] < 5e-12) break;
      order = std::log(error / errors["error_rms_m"]) / std::log(step / errors["step_s"]);
      step = errors["step_s"];
      error = errors["error_rms_m"];
    }
    // The deviation from the formal order is proportional to the time step: it is 0.2 to 0.7 at 1 ms, so less than
    // 0.7 / 500 at 2 us. For rk4, the deviation is proportional to the fourth power of the time step, but at the
    // smallest step used here the rounding error is a hundredth of the error.
    EXPECT_NEAR(order, integrator->damped_order, 0.01) << integrator->info.name;
  }
}

TEST(Integrators, TellWhichKeepTheEnergyOfUndampedSprings) {
  const Panel panel = accuracy::integrators(bundled("springs_oscillation"));
  const auto of = [&](const char* integrator, const char* what) {
    return value(panel, std::string("integrators/") + integrator + " ", what);
  };
  // At the time step dt = 1 ms, the largest angular frequency w of the springs gives w dt = sqrt(2 K dt^2 / M) = 0.45
  // (lambda_max = 2). The energy of leapfrog oscillates about a constant value by up to w dt / 2 of this value. A step
  // of rk4 loses (w dt)^6 / 72 of the energy.
  EXPECT_GT(of("leapfrog", "undamped_energy_swing_relative"), 0.05);
  EXPECT_LT(of("leapfrog", "undamped_energy_swing_relative"), (1.0 + 0.225) / (1.0 - 0.225) - 1.0);
  EXPECT_LT(of("rk4", "undamped_energy_gain_relative"), 0.0);
  EXPECT_GT(of("rk4", "undamped_energy_gain_relative"), -200 * std::pow(0.45, 6) / 72.0);
  EXPECT_LT(of("implicit_euler", "undamped_energy_gain_relative"), -0.99);
  EXPECT_LT(of("implicit_midpoint", "undamped_energy_swing_relative"), 200 * 20 * 2.3e-16);
}

TEST(Integrators, KeepASettingThatFails) {
  // Use a step of 20 ms, which is far beyond the stability limit.
  const Panel panel = accuracy::integrators(bundled("springs_oscillation", {"time.step_s=0.02", "time.steps=40"}));
  const accuracy::Errors errors = panel.front().errors();
  EXPECT_EQ(errors.outcome, "diverges");
  EXPECT_TRUE(std::isnan(errors["error_rms_m"]));
  EXPECT_EQ(panel.back().errors().outcome, "completes");
}

TEST(Shaping, ApproachesTheExactTensorWithItsIterations) {
  double last = INFINITY;
  for (const Setting& setting : accuracy::shaping(drill())) {
    const double error = setting.errors()["tensor_error_rms"];
    EXPECT_LT(error, last) << setting.name;
    last = error;
  }
  EXPECT_EQ(last, 0.0) << "the exact one is its own reference";
}

TEST(Reduction, OfNothingIsTheReference) {
  const Panel panel = accuracy::reduction(drill());
  EXPECT_EQ(value(panel, "reduction/exact_shaping off", "force_error_relative"), 0.0);
  const double all = value(panel, "reduction/exact_shaping off", "kept_mean");
  for (const Setting& setting : those(panel, "reduction/shaped_stiffness")) {
    EXPECT_GT(setting.errors()["force_error_relative"], 0.0) << setting.name;
    EXPECT_LE(setting.errors()["kept_mean"], all) << setting.name;
  }
}

TEST(Merging, DependsOnTheOrderOfTheContactsOnlyWhereTheyAreReduced) {
  for (const Setting& setting :
       accuracy::merging(bundled("task2_rotate_signed_distance", {"rendering.local_average=false"}))) {
    const accuracy::Errors errors = setting.errors();
    const bool reduced = setting.name.find("reduced") != std::string::npos;
    EXPECT_EQ(errors["kept_mean"] < errors["contacts_mean"], reduced) << setting.name;
    // Without a reduction, another order of the contacts changes sums over up to a thousand contacts only by rounding.
    // exact_shaping divides by its parameter epsilon and so enlarges the rounding error of the weights. With a
    // reduction, the order also decides which contacts are kept.
    EXPECT_EQ(errors["order_spread_relative"] > 1e-9, reduced) << setting.name;
    if (setting.name.starts_with("merging/exact_shaping of all")) {
      EXPECT_EQ(errors["force_error_relative"], 0.0);
    }
  }
}

TEST(MultiRateContacts, OfEveryRowAreThoseOfASingleRate) {
  const Panel panel = accuracy::multi_rate_contacts(bundled("drag_molar", {"time.duration_s=0.05"}));
  EXPECT_EQ(value(panel, "multi_rate_contacts/mean hold 1", "error_rms_m"), 0.0);
  EXPECT_GT(value(panel, "multi_rate_contacts/mean hold 8", "error_rms_m"), 0.0);
  EXPECT_EQ(value(panel, "multi_rate_contacts/mean hold 8", "rate_Hz"), 256.0);
  for (const Setting& setting : accuracy::skips(bundled("drag_molar", {"time.duration_s=0.05"})))
    EXPECT_EQ(setting.errors()["error_rms_m"], 0.0) << setting.name << ": skips change nothing";
}

TEST(Events, OfTheReferenceAreNotMadeBySampling) {
  const Panel panel = accuracy::events(bundled("bounce_plane"));
  EXPECT_EQ(those(panel, "events/event ").back().errors()["created_by_sampling_J"], 0.0);
  EXPECT_GT(value(panel, "events/leapfrog ", "created_by_sampling_J"), 0.0);
}

TEST(Work, IsWhatTheSettingIsOf) {
  const Panel panel = accuracy::integrators(bundled("springs_oscillation"));
  EXPECT_EQ(panel[1].work().count, 2 * panel[0].work().count) << "half the step, twice the steps";
}

}  // namespace
}  // namespace hapbench::accuracy_test
