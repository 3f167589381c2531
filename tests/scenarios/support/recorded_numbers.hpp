#pragma once

#include <filesystem>
#include <map>
#include <string>

/// The numbers on record, in tests/data/numbers.txt: for each bundled scenario and for some commands a line
/// "name file hash …" for each file with numbers, below the last line "columns file column …" of the file. They show
/// that a change of the code has changed no number; no text is in them. They hold for every processor and compiler.
///
/// This renews the record after a change that is meant to change numbers, to be committed with it:
///
///     HAPBENCH_RENEW_NUMBERS=1 build/release/bin/program_test --gtest_filter='*OnRecord*'
namespace hapbench::test {

/// By file and column the hash of the numbers of the column, from top to bottom; words are left out. Files of one name
/// in several folders of a result count as one. summary.json has its groups of metrics in place of columns and, of a
/// single run, the state_hash.
using RecordedNumbers = std::map<std::string, std::map<std::string, std::string>>;
using NumbersByName = std::map<std::string, RecordedNumbers>;

/// The numbers of a directory of results: of all CSV files, and of the metrics in files summary.json.
RecordedNumbers numbers_below(const std::filesystem::path& directory);

/// Compares numbers by name with those on record; fails where any differs, is missing or, among names that do or do not
/// contain a colon as `of_commands` says, is left over, and names its file and column. `some`: names may be left over.
void expect_recorded(bool of_commands, const NumbersByName& found, bool some = false);

}  // namespace hapbench::test
