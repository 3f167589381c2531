#include "tests/scenarios/support/recorded_numbers.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/environment_variable.hpp"
#include "tests/scenarios/support/file_tree.hpp"

namespace hapbench::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;  // the order of the file, which a new name does not change

constexpr const char* kRenew = "HAPBENCH_RENEW_NUMBERS";

/// Makes the C library (glibc 2.33 and later) take the processor for one without fused multiply-add.
constexpr const char* kWithoutFma = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2";

struct RecordLine {
  RecordedNumbers usual, without_fma;
};
using Record = std::map<std::string, RecordLine>;

fs::path record_file() {
  return fs::path(HAPBENCH_TEST_DATA) / "numbers.txt";
}

Record read_record() {
  Record record;
  for (const std::string& text : lines_of(read_file(record_file()))) {
    std::istringstream words(text);
    std::string name;
    RecordLine line;
    words >> name >> line.usual.state >> line.usual.tables;
    line.without_fma = line.usual;
    words >> line.without_fma.state >> line.without_fma.tables;
    record[name] = line;
  }
  return record;
}

bool is_command(const std::string& name) {
  return name.find(':') != std::string::npos;
}

void renew(bool of_commands, const NumbersByName& usual, const NumbersByName& without_fma) {
  Record record = read_record();
  std::erase_if(record, [&](const auto& line) { return is_command(line.first) == of_commands; });
  for (const auto& [name, numbers] : usual) record[name] = {numbers, without_fma.at(name)};
  std::string text;
  for (const auto& [name, line] : record) {
    text += name + " " + line.usual.state + " " + line.usual.tables;
    if (line.without_fma != line.usual) text += " " + line.without_fma.state + " " + line.without_fma.tables;
    text += "\n";
  }
  write_plainly(record_file(), text);
}

bool has_fma() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("fma") && __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

void add_table(Hash64& hash, const std::string& text) {
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    for (const std::string& cell : cells_of(lines[i])) {
      double number = 0.0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
      if (error == std::errc() && end == cell.data() + cell.size()) hash.real(number);
    }
  }
}

void add_numbers(Hash64& hash, const Json& json) {
  if (json.is_number()) hash.real(json.get<double>());
  if (!json.is_structured()) return;
  for (const Json& value : json) add_numbers(hash, value);
}

/// The lines of what differs.
std::string differences(const NumbersByName& found, const NumbersByName& expected) {
  std::string text;
  const auto part = [](bool same) { return same ? "same" : "OTHER"; };
  for (const auto& [name, numbers] : found) {
    const auto line = expected.find(name);
    if (line == expected.end()) {
      text += "  " + name + ": is not on record\n";
    } else if (line->second != numbers) {
      text += "  " + name + ": state " + part(line->second.state == numbers.state) + ", tables " +
              part(line->second.tables == numbers.tables) + "\n";
    }
  }
  for (const auto& [name, numbers] : expected) {
    if (!found.contains(name)) text += "  " + name + ": is on record only\n";
  }
  return text;
}

}  // namespace

RecordedNumbers numbers_below(const fs::path& directory) {
  RecordedNumbers numbers{"-", ""};
  Hash64 hash;
  for (const auto& [name, contents] : files_below(directory)) {
    const std::string file = fs::path(name).filename().string();
    if (file.ends_with(".csv")) {
      add_table(hash, contents);
    } else if (file == "summary.json") {
      const Json summary = Json::parse(contents);
      add_numbers(hash, summary.at("metrics"));
      if (name == file) numbers.state = summary.at("state_hash");
    } else if (file.starts_with("worst_") && file.ends_with(".json")) {
      add_numbers(hash, Json::parse(contents));
    }
  }
  numbers.tables = hash_text(hash.value());
  return numbers;
}

void expect_recorded(bool of_commands, const std::function<NumbersByName()>& measured) {
  const NumbersByName found = measured();
  ASSERT_FALSE(found.empty());
  if (std::getenv(kRenew) != nullptr) {
    ASSERT_TRUE(has_fma()) << "the record is renewed on an x86-64 with fused multiply-add";
    const EnvironmentVariable tunables("GLIBC_TUNABLES", kWithoutFma);
    renew(of_commands, found, measured());
    return;
  }
  NumbersByName usual, without_fma;
  for (const auto& [name, line] : read_record()) {
    if (is_command(name) != of_commands) continue;
    usual[name] = line.usual;
    without_fma[name] = line.without_fma;
  }
  const std::string with = differences(found, usual), without = differences(found, without_fma);
  // Whichever the C library does, it does throughout.
  EXPECT_TRUE(with.empty() || without.empty())
      << "other numbers than those on record:\n"
      << (with.size() <= without.size() ? with : without) << "If they are meant to change, renew " << record_file()
      << " with " << kRenew << "=1, and say in the commit which change and why.";
}

}  // namespace hapbench::test
