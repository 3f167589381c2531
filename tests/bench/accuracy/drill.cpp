#include <fmt/format.h>

#include <algorithm>

#include "algorithms/registry.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "tests/bench/accuracy/accuracy.hpp"

/// Panels of a drill that a hand presses into a hole while it turns.
namespace hapbench::accuracy {
namespace {

constexpr double kShellSpacings[] = {0.0004, 0.0002, 0.0001, 0.00005, 0.000025};
constexpr std::pair<const char*, Density> kDensities[] = {{"signed_distance", Density::signed_distance},
                                                          {"binary", Density::binary}};

/// The algorithms of the thesis, whose angular damping is compared with damping of the tip's velocity alone.
constexpr const char* kAngularlyDamped[] = {"original_averaging", "shaped_stiffness"};

/// Off the ideal trajectory, over the rows in which the hand is gentle, if it ever is; and the largest change of the
/// force in a step of all rows.
Errors off_the_ideal(const Scenario& scenario, std::shared_ptr<const PointShell> shell) {
  IdealTrajectoryObserver ideal(std::get<BlockEnvironment>(scenario.environment).block, make_cylinder(scenario.tool));
  MetricsObserver motion(scenario.time.step);
  const SampledRun run = sampled_run(scenario, std::move(shell), 1, {&ideal, &motion});
  const MetricList metrics = told(ideal);
  const std::string hand = number_of(metrics, "gentle.rows") > 0.0 ? "gentle." : "firm.";
  const auto error = [&](const char* name) { return number_of(metrics, hand + name).value_or(0.0); };
  return {std::string(outcome_name(run.result.outcome)),
          {{"ideal_height_error_rms_m", error("height_error_rms_m")},
           {"ideal_height_error_max_m", std::max(-error("height_error_min_m"), error("height_error_max_m"))},
           {"ideal_lateral_error_rms_m", error("lateral_error_rms_m")},
           {"interpenetration_max_m", error("interpenetration_max_m")},
           {"force_step_max_N", told(motion, "force_step_max_N").value_or(0.0)}}};
}

}  // namespace

Panel spacing(const Scenario& drill) {
  Panel panel;
  for (const auto& [name, density] : kDensities) {
    for (const double grid : kShellSpacings) {
      Scenario run = drill_in_hole(drill);
      auto& block = std::get<BlockEnvironment>(run.environment);
      block.density = density;
      block.grid = grid;
      const auto shell = once([run] { return make_shell(run); });
      const auto errors = [=] {
        Errors off = off_the_ideal(run, shell());
        off.values.insert(off.values.begin(),
                          {{"spacing_m", grid},
                           {"points", static_cast<double>(shell()->size())},
                           {"shell_bytes", static_cast<double>(shell()->padded_size() * 6 * sizeof(double))}});
        return off;
      };
      panel.push_back(
          {fmt::format("spacing/{} {}", name, grid), "step", errors, [=] { return bare_run(run, shell()); }});
    }
  }
  return panel;
}

Panel algorithms(const Scenario& drill) {
  const Scenario scenario = drill_in_hole(drill);
  const auto shell = once([scenario] { return make_shell(scenario); });
  Panel panel;
  const auto add = [&](const std::string& setting, const RenderingConfig& config) {
    Scenario run = scenario;
    run.rendering = with_fixed_stages(config);
    panel.push_back({"algorithms/" + setting, "step", [=] { return off_the_ideal(run, shell()); },
                     [=] { return bare_run(run, shell()); }});
  };
  RenderingConfig config = scenario.rendering;
  // Off, except in the settings that are named after them.
  config.angular_damping = config.passivity_controller = false;
  for (const AlgorithmEntry& algorithm : hapbench::algorithms()) {
    config.algorithm = algorithm.info->name;
    add(config.algorithm, config);
  }
  for (const char* algorithm : kAngularlyDamped) {
    config.algorithm = algorithm;
    config.angular_damping = true;
    add(config.algorithm + " + angular_damping", config);
  }
  config.angular_damping = false;
  for (const AlgorithmEntry& algorithm : hapbench::algorithms()) {
    if (!algorithm.creates_energy) continue;
    config.algorithm = algorithm.info->name;
    config.passivity_controller = true;
    add(config.algorithm + " + passivity_controller", config);
  }
  return panel;
}

}  // namespace hapbench::accuracy
