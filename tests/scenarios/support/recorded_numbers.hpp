#pragma once

#include <filesystem>
#include <map>
#include <string>

/// The numbers on record, in tests/data/numbers.txt: a line "name state_hash tables_hash" for each bundled scenario and
/// for some commands. They show that a change of the code has changed no number; no text is in them. They hold for
/// every processor and compiler.
///
/// This renews the record after a change that is meant to change numbers, to be committed with it:
///
///     HAPBENCH_RENEW_NUMBERS=1 build/release/bin/program_test --gtest_filter='*OnRecord*'
namespace hapbench::test {

struct RecordedNumbers {
  std::string state;   ///< state_hash of summary.json; "-" for results of several runs
  std::string tables;  ///< hash of the bits of all numbers in tables, headers and words left out
  bool operator==(const RecordedNumbers&) const = default;
};
using NumbersByName = std::map<std::string, RecordedNumbers>;

/// The numbers of a directory of results: of all CSV files, and of the metrics in files summary.json.
RecordedNumbers numbers_below(const std::filesystem::path& directory);

/// Compares numbers by name with those on record; fails where any differs, is missing or, among names that do or do not
/// contain a colon as `of_commands` says, is left over.
void expect_recorded(bool of_commands, const NumbersByName& found);

}  // namespace hapbench::test
