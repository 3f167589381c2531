#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hapbench::test {

/// Contents of all files below a directory, hidden ones included, by their path from there.
std::map<std::string, std::string> files_below(const std::filesystem::path& directory);

/// The paths of those files alone.
std::vector<std::string> names_below(const std::filesystem::path& directory);

/// Fails the test unless both directories hold the same files with the same bytes; `ignored` names are not compared.
void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b,
                       const std::vector<std::string>& ignored = {});

}  // namespace hapbench::test
