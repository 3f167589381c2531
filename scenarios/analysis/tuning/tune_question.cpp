#include "scenarios/analysis/tuning/tune_question.hpp"

#include <variant>

#include "scenarios/analysis/stability/limit_question.hpp"

namespace hapbench {

TuneRanges tune_ranges(const TuneQuestion& question, const std::string& algorithm) {
  std::vector<std::string> overrides = question.overrides;
  overrides.push_back("rendering.algorithm=" + algorithm);
  TuneRanges ranges;
  ranges.stiffness = limit_question(question.scenario, overrides, kStiffnessPath, {}).search.range;
  const Scenario scene = load_scenario(question.scenario, overrides).scenario;
  if (!scene.rendering.hunt_crossley) {
    ranges.damping_ratio = question.damping_ratio;
    ranges.damping_ratio->logarithmic = true;
  }
  if (std::holds_alternative<AdmittanceDeviceConfig>(scene.device))
    ranges.mass = question.mass.value_or(Range{0.5 * scene.rendering.mass, 2.0 * scene.rendering.mass, true});
  return ranges;
}

}  // namespace hapbench
