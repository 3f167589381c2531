#pragma once

#include "scenarios/thesis/claims.hpp"

/// The ledger's files: the verdict on each claim, and its robustness against the choices on record.
namespace hapbench {

/// What robustness.json says of a claim, if the recorded verdict is this one and the choices that reach it are the
/// same; else null. Throws InputError when it is no such record.
Json robustness_on_record(const Json& record, const JudgedClaim& judged);

/// claims.json: the headline and the claims; with the cases of those whose numbers a figure draws. `robustness` has
/// what robustness.json holds.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness);

/// claims.md, of what ledger_json gives: the main results, counts by chapter, the claims of the thesis, those that are
/// contradicted first, what was found on the way.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
