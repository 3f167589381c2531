#include "tests/scenarios/support/shortened.hpp"

#include <fmt/format.h>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench::test {

std::vector<std::string> shortened(const BundledScenario& bundled) {
  const Scenario scenario = load_scenario(bundled.file).scenario;
  const bool tracking = std::holds_alternative<TrackingHandFields>(scenario.hand);
  if (scenario.time.steps <= 10'000) return {};
  std::vector<std::string> arguments = {
      "--set",
      R"(expect={"outcome": ["completes", "leaves_hole", "tool_horizontal", "not_dragged", "no_contact", "lost_contact", "diverges"]})",
      "--set", fmt::format("time={{\"step_s\": {}, \"steps\": 2000}}", scenario.time.step)};
  if (tracking) arguments.insert(arguments.end(), {"--set", "hand.trials=1"});
  return arguments;
}

}  // namespace hapbench::test
