#pragma once

#include "scenarios/analysis/stability/field_limit.hpp"

/// Selects the value of a stability limit that the program reports as usable.
namespace hapbench {

/// Returns the value to quote and the reason why it is this value: the simulated or the linear limit, whichever the
/// field reaches first on its way from stable to unstable values. Returns no value if no limit was found, for example
/// if every run up to the end of the range is stable and there is no linear limit: the end of a range is no limit. Also
/// returns no value if no value of the field is stable by both limits. If runs are stable beyond the linear limit, the
/// reason names the measured property of the run at the simulated limit that may explain the difference. Precondition:
/// all members of `limit` except `quoted` are set.
QuotedLimit quoted_limit(const LimitQuestion& question, const FieldLimit& limit);

}  // namespace hapbench
