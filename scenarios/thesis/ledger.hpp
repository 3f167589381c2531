#pragma once

#include <string>
#include <vector>

#include "scenarios/format/json_file.hpp"
#include "scenarios/thesis/claims.hpp"

/// The ledger's files: the verdict on each claim, and its robustness against the choices on record.
namespace hapbench {

/// What robustness.json says of a claim, if the recorded verdict is this one and the choices that reach it are the
/// same; else null. Throws InputError when it is no such record.
Json robustness_on_record(const Json& record, const JudgedClaim& judged);

/// claims.json: the headline and the claims. `robustness` has what robustness.json holds.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness);

// The functions below take a claim as ledger_json writes it.

/// The recorded verdict, and in front of it that of most samples if it is another one.
std::string verdicts_text(const Json& claim);
/// Its entry "sureness", the counts in words: "this verdict in 91 of 100 samples; decided by task2.hand_angle (S =
/// 0.43)"; or why there are none.
std::string robustness_text(const Json& claim);
/// How many verdicts another reasonable reading would leave as they are, and which it would not.
std::string ledger_headline(const Json& claims);
/// claims.md: the headline, the claims of the thesis, and what was found on the way.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
