#include "tests/scenarios/support/recorded_hashes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <sstream>

#include "results/summary/provenance.hpp"
#include "scenarios/input/json_file.hpp"
#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"

namespace hapbench::test {
namespace {

namespace fs = std::filesystem;

/// Results do not depend on the instruction set the code was compiled for, but the C library has a sine and an
/// exponential of its own for processors with fused multiply-add.
fs::path record_file() {
  std::string compiler = provenance().compiler;
  for (char& c : compiler) {
    if (c == ' ') c = '-';
  }
#if defined(__x86_64__)
  const char* processor = __builtin_cpu_supports("fma") ? "x86-64-fma" : "x86-64";
#else
  const char* processor = "other";
#endif
  return fs::path(HAPBENCH_TEST_DATA) / "hashes" / fmt::format("{}_{}.txt", compiler, processor);
}

/// Lines of "name hash".
std::map<std::string, std::string> read_record(const fs::path& file) {
  std::map<std::string, std::string> hashes;
  if (!fs::exists(file)) return hashes;
  for (const std::string& line : lines_of(read_file(file))) {
    const std::size_t space = line.rfind(' ');
    if (space != std::string::npos) hashes[line.substr(0, space)] = line.substr(space + 1);
  }
  return hashes;
}

/// Takes the directories off the files that a scenario names: results are written relative to where they are.
void keep_file_names(Json& json) {
  if (!json.is_structured()) return;
  for (auto& [key, value] : json.items()) {
    if (key == "file" && value.is_string()) value = fs::path(value.get<std::string>()).filename().string();
    keep_file_names(value);
  }
}

void renew(const fs::path& file, const std::string& prefix, const std::map<std::string, std::string>& hashes) {
  std::map<std::string, std::string> record = read_record(file);
  std::erase_if(record, [&prefix](const auto& entry) { return entry.first.starts_with(prefix); });
  record.insert(hashes.begin(), hashes.end());
  std::string text;
  for (const auto& [name, hash] : record) text += name + " " + hash + "\n";
  fs::create_directories(file.parent_path());
  write_plainly(file, text);
}

}  // namespace

std::string hash_of_results(const fs::path& directory) {
  Hash64 hash;
  for (auto& [name, contents] : files_below(directory)) {
    const fs::path path(name);
    if (path.filename() == "timing.json") continue;
    hash.bytes(name);
    if (path.extension() != ".json") {
      hash.bytes(contents);
      continue;
    }
    Json json = Json::parse(contents);
    if (json.is_object()) {
      // "program" and "definition" are a sweep's: which program made it, and a hash over that as well.
      for (const char* of_the_build : {"provenance", "program", "definition"}) json.erase(of_the_build);
    }
    keep_file_names(json);
    hash.bytes(json.dump());
  }
  return hash_text(hash.value());
}

void expect_recorded(const std::string& prefix, const std::map<std::string, std::string>& hashes) {
  const fs::path file = record_file();
  ASSERT_FALSE(hashes.empty());
  if (std::getenv("HAPBENCH_RENEW_HASHES") != nullptr) {
    renew(file, prefix, hashes);
    return;
  }
  std::map<std::string, std::string> record = read_record(file);
  if (record.empty()) GTEST_SKIP() << "no record for this compiler and processor: " << file;
  std::erase_if(record, [&prefix](const auto& entry) { return !entry.first.starts_with(prefix); });
  for (const auto& [name, hash] : hashes) {
    EXPECT_EQ(hash, record[name]) << name << " has other results than those on record in " << file;
  }
  for (const auto& [name, hash] : record) EXPECT_TRUE(hashes.contains(name)) << name << " is on record only";
}

}  // namespace hapbench::test
