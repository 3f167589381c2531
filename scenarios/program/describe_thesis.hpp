#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/describe_results.hpp"

/// What `hapbench describe` says of the thesis: its claims and its places.
namespace hapbench {

/// The claims of results/reference/claims.json, as they stand there (thesis_claims/ledger.hpp). Throws InputError.
Json claims_on_record();

/// The claim of that id, in either case; or what names that place of the thesis, as "A.2", "Fig. A.2", "Table A.1" or
/// "section 3.4": bundled scenarios by their source, claims by their place. A place counts with its parts: 3.4 with
/// 3.4.1, Fig. 2 with Fig. 2c. Nothing for other names. Throws InputError.
std::vector<Description> describe_thesis(const std::string& name);

}  // namespace hapbench
