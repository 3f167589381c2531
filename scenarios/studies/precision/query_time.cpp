#include <fmt/format.h>

#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"

/// Measures how long the search for contacts takes in a step over the depth of the tool, which touches more and more
/// points as it sinks in.
namespace hapbench {
namespace {

constexpr double kDeeper = 5.0;  ///< how many times as far as the scenario's stroke the tool goes
constexpr std::size_t kLevels = 10;
constexpr std::size_t kPoses = 256;  ///< poses from one level to the next

struct Way {
  const char* name;
  Skips skips;
};
constexpr Way kWays[] = {{"neighbour_list", Skips::on}, {"every_point", Skips::off}};

/// The straight way from the stroke's start through its farthest point.
struct Push {
  ToolPose start;
  Vec3 way;  ///< to the deepest place [m]

  ToolPose at(std::size_t level, std::size_t pose) const {
    ToolPose there = start;
    there.position += static_cast<double>(level * kPoses + pose + 1) / static_cast<double>(kLevels * kPoses) * way;
    return there;
  }
};

Push push_of(const Scenario& scenario, const Motion& motion) {
  if (motion.position_is_free()) {
    throw InputError(InputError::Kind::relation, "/motion/position/type",
                     "got \"free\"; allowed for this study: a prescribed position, as in the scenarios quality/*");
  }
  const SimulationConfig config = simulation_config(scenario);
  const Vec3 start = motion.position_at(0.0);
  Vec3 farthest = Vec3::Zero();
  for (std::uint64_t row = 0; row < config.steps; ++row) {
    const Vec3 way = motion.position_at(static_cast<double>(row) * config.dt) - start;
    if (way.squaredNorm() > farthest.squaredNorm()) farthest = way;
  }
  return {{start, motion.axis_at(0.0), motion.roll_at(0.0)}, kDeeper * farthest};
}

PrecisionRow row_of(const Way& way, const Push& push, std::size_t level, SimulationParts& parts, int repetitions) {
  ContactBuffer contacts(parts.source->capacity());
  parts.source->reset();
  std::vector<ToolPose> poses;  // made before the time is taken
  for (std::size_t pose = 0; pose < kPoses; ++pose) poses.push_back(push.at(level, pose));
  double depth = 0.0, count = 0.0;
  for (const ToolPose& pose : poses) {
    parts.source->contacts_at(pose, contacts);
    depth += contacts.largest_depth();
    count += static_cast<double>(contacts.size());
  }
  const auto tested = static_cast<double>(parts.source->work().points_tested);
  const double seconds = seconds_per_call(kPoses, repetitions, [&] {
    for (const ToolPose& pose : poses) parts.source->contacts_at(pose, contacts);
  });
  const double n = static_cast<double>(kPoses);
  const double pushed = (poses[kPoses / 2].position - push.start.position).norm();
  return {fmt::format("{} {:.4g}mm", way.name, 1e3 * pushed),
          "completes",
          {pushed, depth / n, count / n, tested / n},
          seconds};
}

}  // namespace

static PrecisionResult study_query_time(const Scenario& given, const PrecisionOptions& options) {
  PrecisionResult result;
  result.columns = {"pushed_m", "depth_max_mean_m", "contacts_mean", "points_tested_mean"};
  result.timed = "call";
  const std::shared_ptr<const PointShell> shell = make_shell(given);
  for (const Way& way : kWays) {
    Scenario scenario = given;
    scenario.rendering.skips = way.skips;
    SimulationParts parts = assemble(scenario, shell, {});
    const Push push = push_of(scenario, *parts.motion);
    for (std::size_t level = 0; level < kLevels; ++level) {
      result.add(row_of(way, push, level, parts, options.repetitions), options, kLevels * std::size(kWays));
    }
  }
  return result;
}

const PrecisionStudy kQueryTimeStudy = {
    "query_time", "the search for contacts and depths over penetration depth, a stroke gone five times as far",
    "plane_pressed_round", study_query_time};

}  // namespace hapbench
