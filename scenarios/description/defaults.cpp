#include <fmt/format.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/description/values.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

constexpr double kMostDelaySamples = 1e6;  ///< that a simulated subject keeps in mind

/// What the thesis uses in each kind of scene (Tables A.1, A.2, B.1; reduction 2.8).
struct SceneDefaults {
  Vec3 up;
  double tool_length;
  const char* tip;
  double mass;
  double mu_s;
  double mu_f;
  std::optional<ReductionConfig> reduction;
};

SceneDefaults scene_defaults(const Environment& environment) {
  if (std::holds_alternative<SpringsEnvironment>(environment)) return {{0, 1, 0}, 0.01, "flat", 0.2, 0.0, 0.0, {}};
  if (std::holds_alternative<Hole2d>(environment)) return {{0, 1, 0}, 0.005, "round", 0.2, 5.0, 10.0, {}};
  return {{0, 0, 1}, 0.01, "flat", 0.1, 5.0, 10.0, ReductionConfig{}};
}

template <class T>
void fill(std::optional<T>& field, const T& value) {
  if (!field) field = value;
}

void fill_time(TimeFields& time) {
  if (time.steps) return;
  time.steps = static_cast<std::int64_t>(std::round(*time.duration / time.step));
  time.duration.reset();
}

void fill_orientation(Scenario& scenario, const SceneDefaults& defaults) {
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position)) return;
  fill(scenario.motion.orientation, {});
  OrientationFields& orientation = *scenario.motion.orientation;
  fill(orientation.up, defaults.up);
  const double up = orientation.up->norm(), lean = orientation.lean.norm();
  // 1e-9 forgives the rounding of directions that were normalised by somebody else.
  if (up >= 1e-12 && lean >= 1e-12 && std::abs(orientation.up->dot(orientation.lean)) <= 1e-9 * up * lean) return;
  throw InputError(InputError::Kind::relation, "/motion/orientation",
                   "got up " + shown(vector3({0, 0})->write(*orientation.up)) + " and lean " +
                       shown(vector3({0, 0})->write(orientation.lean)) +
                       "; allowed: two perpendicular directions, not zero");
}

/// Puts what the algorithm's definition fixes in place of what was given.
void fill_stages(Scenario& scenario, const SceneDefaults& defaults, std::vector<std::string>& warnings) {
  RenderingFields& rendering = scenario.rendering;
  const AlgorithmEntry& algorithm = *find_algorithm(rendering.config.algorithm);
  const bool has_depth_model = !std::holds_alternative<SpringsEnvironment>(scenario.environment);
  if (!algorithm.fixed_depth_model.empty()) {
    const std::string fixed(algorithm.fixed_depth_model);
    if (has_depth_model && rendering.depth_model && *rendering.depth_model != fixed) {
      warnings.push_back("/rendering/depth_model: \"" + *rendering.depth_model + "\" is not used: algorithm \"" +
                         rendering.config.algorithm + "\" is defined with \"" + fixed + "\"");
    }
    rendering.depth_model = fixed;
  }
  if (!algorithm.may_reduce) {
    if (rendering.reduction && *rendering.reduction) {
      warnings.push_back("/rendering/reduction: not used: algorithm \"" + rendering.config.algorithm +
                         "\" is defined without");
    }
    rendering.reduction = std::optional<ReductionConfig>{};
  }
  fill(rendering.depth_model, RenderingConfig{}.depth_model);
  fill(rendering.reduction, defaults.reduction);
}

void check_local_average(const Scenario& scenario) {
  if (!scenario.rendering.config.local_average) return;
  const auto* shell = std::get_if<PointShellEnvironment>(&scenario.environment);
  const auto* mesh = std::get_if<MeshEnvironment>(&scenario.environment);
  const bool springs = std::holds_alternative<SpringsEnvironment>(scenario.environment);
  const bool no_grid = (shell != nullptr && !shell->grid) || (mesh != nullptr && !mesh->grid);
  if (!springs && !no_grid) return;
  throw InputError(InputError::Kind::relation, "/rendering/local_average",
                   springs ? "got true; allowed: false, because springs have no grid cells"
                           : "got true; allowed: false, unless environment.grid_m gives the cells");
}

void check_ideal_trajectory(const Scenario& scenario) {
  if (!scenario.record.ideal_trajectory) return;
  const bool block = std::holds_alternative<BlockEnvironment>(scenario.environment);
  if (block && *scenario.tool.tip == "flat") return;
  throw InputError(InputError::Kind::relation, "/record/ideal_trajectory",
                   "got true; allowed: false, unless the environment is block_with_hole and the tool's tip flat");
}

void check_tracking_hand(const Scenario& scenario) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  if (!std::holds_alternative<FreePosition>(scenario.motion.position)) {
    throw InputError(InputError::Kind::relation, "/motion/position/type",
                     "got a prescribed position; allowed: \"free\" with hand \"tracking\", which moves the tool");
  }
  for (std::size_t i = 0; i < hand->subjects.size(); ++i) {
    const double samples = hand->subjects[i].reaction_delay / scenario.time.step;
    if (samples <= kMostDelaySamples) continue;
    throw InputError(InputError::Kind::relation, fmt::format("/hand/subjects/{}/reaction_delay_s", i),
                     fmt::format("got {:.3g} time steps; allowed: at most {:.0g}", samples, kMostDelaySamples));
  }
  const double trials = static_cast<double>(hand->subjects.size()) * static_cast<double>(hand->trials);
  const double steps = trials * static_cast<double>(*scenario.time.steps);
  if (steps <= kMostSteps) return;
  throw InputError(InputError::Kind::relation, "/hand/trials",
                   fmt::format("got {:.3g} steps in all trials; allowed: at most {:.0g}", steps, kMostSteps));
}

}  // namespace

bool records_rows(const RecordFields& record) {
  return record.trajectory || !record.ratio_iterations.empty() || record.contacts || record.stiffness_tensor ||
         record.energy || record.ideal_trajectory;
}

std::filesystem::path resolve_path(const Scenario& scenario, const std::string& file) {
  return scenario.directory / file;  // an absolute `file` replaces the directory
}

std::vector<std::string> fill_defaults(Scenario& scenario) {
  std::vector<std::string> warnings;
  const SceneDefaults defaults = scene_defaults(scenario.environment);
  fill_time(scenario.time);
  fill(scenario.tool.diameter, 0.001);
  fill(scenario.tool.length, defaults.tool_length);
  fill(scenario.tool.tip, std::string(defaults.tip));
  fill_orientation(scenario, defaults);
  fill(scenario.rendering.mass, defaults.mass);
  fill(scenario.rendering.mu_s, defaults.mu_s);
  fill(scenario.rendering.mu_f, defaults.mu_f);
  fill_stages(scenario, defaults, warnings);
  check_local_average(scenario);
  check_ideal_trajectory(scenario);
  check_tracking_hand(scenario);
  return warnings;
}

}  // namespace hapbench
