#include "results/summary/outcome_names.hpp"

#include <algorithm>
#include <array>

namespace hapbench {
namespace {

/// In the order of the enumeration.
constexpr std::array<std::string_view, 7> kNames = {"completes",  "leaves_hole",  "tool_horizontal", "not_dragged",
                                                    "no_contact", "lost_contact", "diverges"};
static_assert(static_cast<std::size_t>(Outcome::diverges) == kNames.size() - 1);

}  // namespace

std::string_view outcome_name(Outcome outcome) noexcept {
  return kNames[static_cast<std::size_t>(outcome)];
}

std::optional<Outcome> outcome_named(std::string_view name) noexcept {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Outcome>(found - kNames.begin());
}

std::span<const std::string_view> outcome_names() noexcept {
  return kNames;
}

}  // namespace hapbench
