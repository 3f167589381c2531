#include "scenarios/renderer/replayed_passage.hpp"

#include <fmt/format.h>

#include "scenarios/run/quantity_text.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/tools.hpp"

namespace hapbench {

ReplayedPassage::ReplayedPassage(const CheckedScenario& scenario)
    : tool_(make_tool(scenario.scenario(), scenario.files())) {
  if (auto solid = make_solid(scenario.scenario(), scenario.files())) inside_.emplace(tool_, std::move(solid));
}

void ReplayedPassage::add(const LiveRenderer& renderer, const HapbenchOutput& output, double time) noexcept {
  // Calls with these states render nothing; the pose of the tool then need not be valid.
  if (!inside_ || output.status == HAPBENCH_STALE || output.status == HAPBENCH_FAULT) return;
  record_.time = time;
  record_.tool = renderer.tool();
  record_.force.depth_max = renderer.deepest_contact();
  inside_->on_step(record_);
  ++record_.step;
}

std::optional<bool> ReplayedPassage::went_through() const {
  if (!inside_) return {};
  return inside_->has_passed() || inside_->passage().ends_inside;
}

std::string ReplayedPassage::text() const {
  if (!went_through().value_or(false)) return "";
  const Passage& passage = inside_->passage();
  if (passage.deep)
    return fmt::format("at {:.4g} s, its tip centre was deeper below the surface than the half width of the tool, {}",
                       passage.deep->time, length_text(tool_->half_width()));
  if (passage.left)
    return fmt::format("it entered the environment at {} and left it on another side at {:.4g} s at {}",
                       position_text(passage.entered), passage.left->time, position_text(passage.left->point));
  if (const auto& core = inside_->core_passage().event())
    return fmt::format("at {:.4g} s, its axis reached from {} through the environment to {}", core->time,
                       position_text(core->entered), position_text(core->left));
  return "its core was inside the environment at the end";
}

}  // namespace hapbench
