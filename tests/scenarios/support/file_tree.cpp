#include "tests/scenarios/support/file_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/results/files.hpp"

namespace hapbench::test {

namespace fs = std::filesystem;

std::map<std::string, std::string> files_below(const fs::path& directory) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (!entry.is_regular_file()) continue;
    files[entry.path().lexically_relative(directory).generic_string()] = read_file(entry.path());
  }
  return files;
}

std::vector<std::string> names_below(const fs::path& directory) {
  std::vector<std::string> names;
  for (const auto& [name, contents] : files_below(directory)) names.push_back(name);
  return names;
}

void expect_same_files(const fs::path& a, const fs::path& b, const std::vector<std::string>& ignored) {
  auto in_a = files_below(a), in_b = files_below(b);
  for (auto* files : {&in_a, &in_b}) {
    std::erase_if(*files, [&ignored](const auto& file) {
      const std::string name = fs::path(file.first).filename().string();
      return std::find(ignored.begin(), ignored.end(), name) != ignored.end();
    });
  }
  EXPECT_FALSE(in_a.empty());
  for (const auto& [name, contents] : in_a) {
    ASSERT_TRUE(in_b.contains(name)) << name << " is only in " << a;
    EXPECT_TRUE(in_b[name] == contents) << name << " differs";  // not EXPECT_EQ, which would print megabytes
  }
  for (const auto& [name, contents] : in_b) EXPECT_TRUE(in_a.contains(name)) << name << " is only in " << b;
}

}  // namespace hapbench::test
