#include "results/summary/outcome.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace hapbench {
namespace {

constexpr const char* kLeftForGood =
    "in the first step after which a freely moving tool cannot return. In this step, the tip centre is further from "
    "the environment's bounding box than the sum of the box's diagonal and the tool's extent, and neither the tool's "
    "velocity nor the hand's force points back to the box. The device is ideal, and the hand is none or exerts a "
    "constant force; any other hand could bring the tool back";

constexpr OutcomeInfo kOutcomes[] = {
    {"completes", "all steps were computed, or the hand finished its task"},
    {"leaves_hole", "stop condition: the tip centre rose above height 0"},
    {"tool_horizontal", "stop condition: the tool's axis reached the horizontal plane"},
    {"not_dragged",
     "all steps were computed, but a hand of type drag moved the tool by less than its width along the path, although "
     "it should have moved the tool by more than two widths",
     true},
    {"stuck",
     "all steps were computed, but one of these holds. (1) At the end the tool stood still, and not because the hand "
     "pressed it against the surface: while the hand's target moved on by more than the tool's width, the tool moved "
     "by less than a tenth of the target's distance. The target is the moving target of a hand of type drag, "
     "impedance or mass_spring_damper, or the intended position of a hand of type tracking. (2) A tool led by a hand "
     "of type drag ended behind the target by more than a tenth of the target's distance along the path, and by more "
     "than the tool's half width. A tool that was at least half as far behind at half of the path does not count, "
     "because friction has this effect",
     true},
    {"no_contact", "all steps were computed, and the tool never touched the environment", true, kLeftForGood},
    {"lost_contact",
     "all steps were computed, but one of these holds. (1) At the end, the tip centre of a freely moving tool was "
     "further from the environment's bounding box than the sum of the box's diagonal and the tool's extent. (2) A hand "
     "of type drag pressed its tool without contact for at least the last 0.05 s, for example past an edge or above a "
     "hole",
     true, kLeftForGood},
    {"went_through",
     "all steps were computed, but the tool passed through the surface, moving freely or by a script. The tool passed "
     "through if one of these holds. (1) The tip centre was deeper than the tool's half width. (2) The core of the "
     "tool crossed the environment from face to face, also where the environment is thinner than the tool. (3) The "
     "core left the environment on a different side than it had entered. (4) At the end, the point on the axis half a "
     "tool width behind the foremost point of the tip was inside. (5) Another part of the tool, such as its shank, was "
     "deeper than the tool's half width, in the deepest step that a search after the run found. This search may miss "
     "a depth by the tolerance of inside_max_m, and is the same whatever the run records; a warning names a run with a "
     "recorded depth above the half width that the search missed. The core is the axis from the tip centre to the far "
     "end of the tool. For a flat tip, the core begins 0.9 half widths behind the tip centre while "
     "no contact is deeper than 0.9 half widths",
     true, "in the first step in which (1), (2) or (3) holds"},
    {"diverges",
     "a value became infinite or not a number, or left its bound (position, speed or force; hapbench describe bounds)",
     true, "in the first step with such a value"}};
static_assert(static_cast<std::size_t>(Outcome::diverges) == std::size(kOutcomes) - 1);

}  // namespace

Outcome outcome_of(Ending ending) noexcept {
  switch (ending) {
    case Ending::completed:
      return Outcome::completes;
    case Ending::left_hole:
      return Outcome::leaves_hole;
    case Ending::tool_horizontal:
      return Outcome::tool_horizontal;
    case Ending::diverged:
      break;
  }
  return Outcome::diverges;
}

std::span<const OutcomeInfo> outcome_infos() noexcept {
  return kOutcomes;
}

std::string_view outcome_name(Outcome outcome) noexcept {
  return kOutcomes[static_cast<std::size_t>(outcome)].name;
}

std::optional<Outcome> outcome_named(std::string_view name) noexcept {
  const auto* found = std::ranges::find(kOutcomes, name, &OutcomeInfo::name);
  if (found == std::end(kOutcomes)) return std::nullopt;
  return static_cast<Outcome>(found - std::begin(kOutcomes));
}

}  // namespace hapbench
