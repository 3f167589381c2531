#include <fmt/format.h>

#include <numbers>

#include "algorithms/registry.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

std::optional<WedgeStiffness> wedge_stiffness(const RenderingConfig& config, double half_angle,
                                              double points_per_face) {
  const AlgorithmEntry* entry = find_algorithm(config.algorithm);
  if (entry == nullptr || entry->theory.wedge_stiffness == nullptr || config.stiffness == 0.0) return std::nullopt;
  return entry->theory.wedge_stiffness(config, half_angle, points_per_face);
}

Scenario with_wedge(Scenario scenario, double half_angle) {
  auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment);
  const bool two_faces = springs != nullptr && springs->random.count == 0 && springs->groups.size() == 2 &&
                         springs->groups[0].count > 0 && springs->groups[0].count == springs->groups[1].count;
  if (!two_faces) {
    throw InputError(InputError::Kind::relation, "/environment",
                     "got no wedge; allowed for this study: springs in two groups of the same count");
  }
  const double c = math::cos(half_angle), s = math::sin(half_angle);
  springs->groups[0].direction = {c, -s, 0.0};
  springs->groups[1].direction = {-c, -s, 0.0};
  return scenario;
}

namespace {

constexpr double kHalfAnglesDegrees[] = {5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 80.0};
/// A tensor of springs is the same in every row in which both faces are touched.
constexpr std::int64_t kSteps = 200;

/// Keeps the tensor and the ratios of the last row.
class LastRow final : public Observer {
 public:
  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override {
    S = record.force.S;
    ratio = record.ratio;
  }
  Mat3 S = Mat3::Zero();
  RatioRange ratio;
};

PrecisionRow wedge_row(const Scenario& scenario, double degrees, int repetitions) {
  const RenderingConfig& config = scenario.rendering;
  const double w = degrees * std::numbers::pi / 180.0;
  const auto& faces = std::get<SpringsEnvironment>(scenario.environment).groups;
  const auto formula = wedge_stiffness(config, w, static_cast<double>(faces.front().count));
  LastRow last;
  const SampledRun run = sampled_run(scenario, nullptr, 1, {&last});
  const auto if_any = [&formula](double WedgeStiffness::*part) {
    return formula ? std::optional((*formula).*part) : std::nullopt;
  };
  return {fmt::format("{} {} deg", config.algorithm, degrees),
          std::string(outcome_name(run.result.outcome)),
          {w, last.ratio.min, last.ratio.max, last.S(1, 1), if_any(&WedgeStiffness::along), last.S(0, 0),
           if_any(&WedgeStiffness::across), lambda_max(last.S)},
          seconds_per_step(scenario, nullptr, repetitions)};
}

}  // namespace

static PrecisionResult study_stiffness(const Scenario& scenario, const PrecisionOptions& options) {
  PrecisionResult result;
  result.columns = {"half_angle_rad", "ratio_min", "ratio_max",      "along_way_out",
                    "along_formula",  "across",    "across_formula", "lambda_max"};
  result.timed = "step";
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const double degrees : kHalfAnglesDegrees) {
      Scenario run = with_wedge(scenario, degrees * std::numbers::pi / 180.0);
      run.time.steps = std::min(run.time.steps, kSteps);
      result.add(wedge_row(with_algorithm(run, algorithm.info->name), degrees, options.repetitions), options,
                 algorithms().size() * std::size(kHalfAnglesDegrees));
    }
  }
  return result;
}

const PrecisionStudy kStiffnessStudy = {
    "stiffness", "every algorithm in a wedge against closed forms: stiffness along the contacts and the way out",
    "wedge_stiffness", study_stiffness};

}  // namespace hapbench
