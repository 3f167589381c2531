#include "results/summary/outcome.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace hapbench {
namespace {

constexpr const char* kLeftForGood =
    "in the first step in which a freely moving tool is that far away and moves on, if the hand is none or pushes "
    "with a constant force that does not point back; any other hand may bring the tool back";

constexpr OutcomeInfo kOutcomes[] = {
    {"completes", "all steps were computed, or the hand finished its task"},
    {"leaves_hole", "stop condition: the tip centre rose above height 0"},
    {"tool_horizontal", "stop condition: the tool's axis reached the horizontal plane"},
    {"not_dragged",
     "all steps were computed, but a hand of type drag, which was to move the tool by more than two tool widths, "
     "moved it by less than one width along the path",
     true},
    {"stuck",
     "all steps were computed, but at the end the tool stood still while the hand's target (drag, impedance, "
     "mass_spring_damper, or the intended position of tracking) moved on by more than the tool's width: the tool "
     "moved by less than a tenth of that distance, and not because it pressed on the surface. Or: a tool led by a "
     "hand of type drag ended behind the path's end by more than a tenth of the path and more than its half width "
     "(unless it was already half as far behind at half of the path, as friction causes)",
     true},
    {"no_contact", "all steps were computed, and the tool never touched the environment", true, kLeftForGood},
    {"lost_contact",
     "all steps were computed, but at the end a freely moving tool was further from the environment's bounding box "
     "than the sum of the box's width and the tool's extent. Or: a hand of type drag pressed its tool into empty "
     "space, past an edge or a hole, without contact for at least the last 0.05 s",
     true, kLeftForGood},
    {"went_through",
     "all steps were computed, but the tool passed through the surface (freely moving or scripted). One of these "
     "holds: the tip centre was deeper than the tool's half width; the core (the axis from the tip centre to the far "
     "end; for a flat tip only from 0.9 half widths behind the tip centre, as long as no contact is that deep) "
     "crossed the environment from face to face, or left it on a different side than it had entered, also where the "
     "environment is thinner than the tool; the point half a width behind the tip ended inside; another part of the "
     "tool, such as its shank, was deeper than its half width",
     true,
     "in the first step in which the tip centre is deeper than the half width, or the core has crossed the environment "
     "or left it on another side"},
    {"diverges",
     "a value became infinite or not a number, or left its bound (position, speed or force; hapbench describe bounds)",
     true, "in the first such step"}};
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
