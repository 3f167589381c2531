#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// The ledger: the verdicts on all claims, written as claims.json and claims.md.
namespace hapbench {

/// Returns the content of claims.json: the headline and the claims. Claims whose numbers a figure plots (Claim::drawn)
/// include their cases. `robustness`: the content of robustness.json. Its entry for a claim is used only if its
/// recorded verdict and its hash of the choices agree with `judged`. Throws InputError if `robustness` has another
/// format.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness);
/// Returns a sentence with the number of claims for each verdict and for each robustness of a verdict: steady (most
/// readings give the same verdict), fragile (most do not), or not sampled.
std::string headline_of(const Json& claims);

/// Returns the content of claims.md from the result of ledger_json: the main results, counts by chapter, the claims of
/// the thesis (contradicted claims first), and the findings of this project.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
