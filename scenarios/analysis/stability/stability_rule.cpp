#include "scenarios/analysis/stability/stability_rule.hpp"

#include "results/observe/contact_forces.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/run/vibration_limit.hpp"

namespace hapbench {

bool StabilityRule::holds(RunVerdict verdict) const noexcept {
  return is_stable(verdict) || (bounded && verdict == RunVerdict::vibrating);
}

StabilityRule rule_of(const Scenario& scenario) {
  StabilityRule rule;
  if (vibration_filter(scenario.time.step) && has_scripted_motion(scenario)) rule.max_vibration = kMaxVibration;
  return rule;
}

}  // namespace hapbench
