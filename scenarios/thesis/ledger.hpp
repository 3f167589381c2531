#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// The ledger: the verdicts on all claims as claims.json and claims.md.
namespace hapbench {

/// Returns claims.json: the headline and the claims; with the cases of those whose numbers a figure draws. `robustness`
/// has what robustness.json holds; of a claim it counts if the recorded verdict is this one and the choices that reach
/// it are the same. Throws InputError when it is no such record.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness);
/// Returns the sentence that says how many claims have which verdict, and how many verdicts are steady.
std::string headline_of(const Json& claims);

/// Returns claims.md, of what ledger_json returns: the main results, counts by chapter, the claims of the thesis, those
/// that are contradicted first, what was found on the way.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
