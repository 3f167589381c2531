#pragma once

#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// About how many bytes a run of the scenario will write [bytes]: rows times columns times 12 of what it records, all
/// trials together. An upper estimate of the rows: every step is done, and for contacts.csv 30 contacts are in each of
/// them. Sizes known beforehand are within a factor of two; that of contacts.csv is a guess. O(1).
double expected_output_bytes(const Scenario& scenario);

}  // namespace hapbench
