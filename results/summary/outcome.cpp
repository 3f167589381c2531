#include "results/summary/outcome.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace hapbench {
namespace {

constexpr OutcomeInfo kOutcomes[] = {
    {"completes", "all steps are done, or the hand has finished its task"},
    {"leaves_hole", "the tip centre rose above height 0"},
    {"tool_horizontal", "the tool's axis reached the horizontal plane"},
    {"not_dragged",
     "all steps are done, but a tool that a hand of type drag was to lead further than two of its widths came less "
     "than one along the path",
     true},
    {"stuck",
     "all steps are done, but the tool stood still in the end while the target of its hand (drag, impedance, "
     "mass_spring_damper, or of tracking the intended position) went on by more than the tool's width: it came less "
     "than a tenth of that, and not because it pressed on the surface; or a tool that a hand of type drag was to "
     "lead ended further behind than a tenth of its way and than its half width, and not because it was half as far "
     "behind at half way, as friction holds it",
     true},
    {"no_contact", "all steps are done, and the tool never touched the environment", true},
    {"lost_contact",
     "all steps are done, but a freely moving tool ended further from the environment's box than the box is wide "
     "and the tool reaches together; or a hand of type drag pressed its tool on where there was no surface, past an "
     "edge or a hole: no contact in the last 0.05 s or longer",
     true},
    {"went_through",
     "all steps are done, but the tool passed the surface, by itself or led by a script: its tip centre came deeper "
     "than its half width, or its core (its axis from the tip centre to the far end; of a flat tip only from 0.9 "
     "half widths behind the tip centre while no contact is as deep as that) crossed the environment from face to "
     "face or left it on another side than it had entered, also where it is thinner than the tool, or the place "
     "half a width behind its tip ended inside, or another part of it, as its shank, came deeper than its half width",
     true},
    {"diverges", "a value stopped being finite or left its bound (describe bounds)", true}};
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
