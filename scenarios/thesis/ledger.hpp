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

/// claims.json: the headline and the claims; with the cases of those whose numbers a figure draws. `robustness` has
/// what robustness.json holds.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness);

// The functions below take a claim as ledger_json writes it.

/// The seconds that it takes to judge it: whole ones, "< 1" for less.
std::string seconds_text(const Json& claim);
/// How many claims have which verdict, and how many verdicts are steady.
std::string ledger_headline(const Json& claims);
/// A row of a claim has at most so many characters; `describe ID` says the rest.
inline constexpr std::size_t kLongestRow = 300;
/// claims.md: the main results, counts by chapter, the claims of the thesis, those that are contradicted first, what
/// was found on the way.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
