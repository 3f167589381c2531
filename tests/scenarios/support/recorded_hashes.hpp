#pragma once

#include <filesystem>
#include <map>
#include <string>

/// The results on record: one hash for each directory of result files, in one small file for each compiler and kind of
/// processor (tests/data/hashes). They show that a change of the code has changed no result. Where a change is meant
/// to, this renews the record, to be committed with it:
///
///     HAPBENCH_RENEW_HASHES=1 build/release/bin/program_test --gtest_filter='*OnRecord*'
namespace hapbench::test {

/// Hash of the names and contents of all files below `directory`, without what differs between two builds or two runs
/// of the same code: "provenance" in JSON files, the directories of files that scenarios name, and timing.json. Sixteen
/// hexadecimal digits.
std::string hash_of_results(const std::filesystem::path& directory);

/// Compares hashes by name with those on record whose names begin with `prefix`; fails the test where any differs, is
/// missing or is left over. Skips the test when there is no record for this compiler and processor.
void expect_recorded(const std::string& prefix, const std::map<std::string, std::string>& hashes);

}  // namespace hapbench::test
