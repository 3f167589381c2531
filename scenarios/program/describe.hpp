#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// The parts of `hapbench describe`. Each function returns one description for each meaning that a name has, and
/// nothing for names that it does not know.
namespace hapbench {

struct Description {
  std::string text;  ///< empty for a schema, which is JSON however it is asked for
  Json json;
};

/// Every name that `hapbench describe` explains, but for claims' places and files.
std::vector<std::string> described_names();

/// The metric of that name, the columns of that name, the file of that name with all its columns; "metrics" or
/// "summary.json" for all metrics, "columns" or "columns.json" for all files.
std::vector<Description> describe_results(const std::string& name);
/// The names it knows.
std::vector<std::string> result_names();

/// The outcome, the class of motion, the verdict or the number of timing.json of that name; "words" for all of them.
std::vector<Description> describe_word(const std::string& name);
/// The names it knows.
std::vector<std::string> described_words();

/// The columns and metrics under a heading of a printed table, such as ">30Hz rms N" or its first line, ">30Hz".
/// Ignores case and blanks.
std::vector<Description> describe_heading(const std::string& name);

/// The claim of that id, in either case; or the bundled scenarios and claims that name that place of the thesis, as
/// "A.2", "Fig. A.2", "Table A.1" or "section 3.4". A place includes its parts: 3.4 includes 3.4.1, Fig. 2 includes
/// Fig. 2c. Throws InputError.
std::vector<Description> describe_thesis(const std::string& name);

/// The choice on record of that id, such as planar.first_tilt. Throws InputError.
std::vector<Description> describe_choice(const std::string& name);
/// The ids of all choices on record. Throws InputError.
std::vector<std::string> choice_names();

/// The claims of results/reference/claims.json (thesis_claims/ledger.hpp). Throws InputError.
Json claims_on_record();

}  // namespace hapbench
