#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"
#include "scenarios/thesis/sensitivity.hpp"

/// The ledger: the verdicts on all claims, written as claims.json and claims.md.
namespace hapbench {

/// Returns the content of claims.json: the headline, the sentences of the abstract and the claims. Claims whose numbers
/// a figure plots (Claim::drawn) include their cases. Uses the entry of a claim in the record of sensitivity only if
/// the entry has the hash JudgedClaim::reach, that is, if the assumptions that can change the claim are the same.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                 const SensitivityRecord& record);
/// Returns a sentence with the number of claims for each verdict and for each robustness of a verdict. Claims about
/// computing time, whose verdicts depend on the machine, are counted separately.
std::string headline_of(const Json& claims);

/// Returns the content of claims.md from the result of ledger_json, in four parts: the claims of the abstract; the
/// claims that failed, and the values of assumptions with which claims have another verdict; all claims by chapter;
/// claims about time, claims that are not testable, changed rules and findings of this project. No cell is shortened.
/// Each id links to a section of claim_pages.md.
std::string ledger_markdown(const Json& ledger);

/// Returns the content of claim_pages.md: a section for each claim, with rule, cases, sensitivity, figure and command.
std::string claim_pages(const Json& ledger);

}  // namespace hapbench
