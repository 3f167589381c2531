#pragma once

#include <string_view>

namespace hapbench {

/// A public name (field, metric, column, file, option or value) that version 0.4.0 renamed.
struct RenamedName {
  std::string_view before;
  std::string_view now;
};

/// All renamed names. Error messages suggest the new name wherever it is allowed. CHANGELOG.md has the same table.
inline constexpr RenamedName kRenamedNames[] = {
    {"league.csv", "ranking.csv"},
    {"standings", "ranking"},
    {"beyond", "first_unstable"},
    {"class_beyond", "first_unstable_class"},
    {"low", "stable_low"},
    {"below", "unstable_below"},
    {"class_below", "unstable_below_class"},
    {"high", "stable_high"},
    {"above", "unstable_above"},
    {"class_above", "unstable_above_class"},
    {"theory", "theoretical_limit"},
    {"closed_form", "closed_form_limit"},
    {"linear", "linear_limit"},
    {"undecided", "undecided_runs"},
    {"worst_hand", "worst_hand_limit"},
    {"no_theory", "no_theory_reason"},
    {"inconsistent_runs", "non_monotonic_runs"},
    {"astray", "non_monotonic_runs"},
    {"linear_edge", "linear_limit_N_per_m"},
    {"edge_in_runs", "simulated_limit_N_per_m"},
    {"scattered", "no_contiguous_interval"},
    {"dying_out", "decaying"},
    {"contacts.asked", "contacts.searches"},
    {"asked", "searches"},
    {"force_stage.taken_J", "force_stage.removed_J"},
    {"taken_J", "removed_J"},
    {"least_press_N", "min_press_N"},
    {"--anew", "--rerun"},
    {"--choices", "--assumptions"},
    {"choice", "assumption"},
    {"choices", "assumptions"},
    {"choices.json", "assumptions.json"},
    {"choices_schema", "assumptions_schema"},
    {"reading", "assumption set"},
    {"robustness.json", "sensitivity.json"},
    {"sureness", "robustness"},
    {"steady", "robust"},
    {"fragile", "sensitive to"},
    {"reproduced", "replicated"},
    {"reproduced in kind", "qualitatively replicated"},
    {"not reproduced", "not replicated"},
    {"refuted", "contradicted"},
    {"not reproducible", "not testable"},
};

/// Returns the new name of `before`; an empty text if this name was not renamed.
constexpr std::string_view new_name_of(std::string_view before) {
  for (const RenamedName& renamed : kRenamedNames)
    if (renamed.before == before) return renamed.now;
  return {};
}

}  // namespace hapbench
