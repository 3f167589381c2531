#include <fmt/format.h>

#include <algorithm>

#include "algorithms/registry.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"

/// Studies whose reference is the ideal trajectory: of the shell's spacing and density, and of the algorithms.
namespace hapbench {
namespace {

constexpr double kShellSpacings[] = {0.0004, 0.0002, 0.0001, 0.00005, 0.000025};

constexpr std::pair<const char*, Density> kDensities[] = {{"signed_distance", Density::signed_distance},
                                                          {"binary", Density::binary}};

/// The algorithms whose angular damping is compared with damping of the tip's velocity alone: those of the thesis.
constexpr const char* kAngularlyDamped[] = {"original_averaging", "shaped_stiffness"};

}  // namespace

static PrecisionResult study_spacing(const Scenario& given, const PrecisionOptions& options) {
  PrecisionResult result;
  result.columns = {"spacing_m", "points", "shell_bytes"};
  result.columns.insert(result.columns.end(), kIdealColumns.begin(), kIdealColumns.end());
  result.timed = "step";
  for (const auto& [name, density] : kDensities) {
    for (const double spacing : kShellSpacings) {
      Scenario scenario = drill_in_hole(given);
      auto& environment = std::get<BlockEnvironment>(scenario.environment);
      environment.density = density;
      environment.grid = spacing;
      const auto shell = make_shell(scenario);
      PrecisionRow row = ideal_run(fmt::format("{} {}", name, spacing), scenario, shell, options.repetitions).row;
      const double points = static_cast<double>(shell->size());
      const double bytes = static_cast<double>(shell->padded_size() * 6 * sizeof(double));
      row.values.insert(row.values.begin(), {spacing, points, bytes});
      result.add(std::move(row), options, std::size(kDensities) * std::size(kShellSpacings));
    }
  }
  return result;
}

static PrecisionResult study_algorithms(const Scenario& given, const PrecisionOptions& options) {
  const Scenario scenario = drill_in_hole(given);
  const auto shell = make_shell(scenario);
  PrecisionResult result;
  result.columns = kIdealColumns;
  result.timed = "step";
  const auto create_energy = std::count_if(algorithms().begin(), algorithms().end(),
                                           [](const AlgorithmEntry& algorithm) { return algorithm.creates_energy; });
  const std::size_t all = algorithms().size() + std::size(kAngularlyDamped) + static_cast<std::size_t>(create_energy);
  const auto add_row = [&](std::string setting, const RenderingConfig& config) {
    Scenario run = scenario;
    run.rendering = with_fixed_stages(config);
    result.add(ideal_run(std::move(setting), run, shell, options.repetitions).row, options, all);
  };
  RenderingConfig config = scenario.rendering;
  // Off, except in the rows whose setting names them.
  config.angular_damping = config.passivity_controller = false;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    config.algorithm = algorithm.info->name;
    add_row(config.algorithm, config);
  }
  for (const char* algorithm : kAngularlyDamped) {
    config.algorithm = algorithm;
    config.angular_damping = true;
    add_row(config.algorithm + " + angular_damping", config);
  }
  config.angular_damping = false;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    if (!algorithm.creates_energy) continue;
    config.algorithm = algorithm.info->name;
    config.passivity_controller = true;
    add_row(config.algorithm + " + passivity_controller", config);
  }
  return result;
}

const PrecisionStudy kSpacingStudy = {"spacing", "shell spacing and density against the ideal trajectory",
                                      "rotate_in_hole", study_spacing};

const PrecisionStudy kAlgorithmsStudy = {"algorithms", "every algorithm against the ideal trajectory", "rotate_in_hole",
                                         study_algorithms};

}  // namespace hapbench
