#include "tests/scenarios/support/recorded_numbers.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"

namespace hapbench::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;  // the order of the file, which a new name does not change

constexpr const char* kRenew = "HAPBENCH_RENEW_NUMBERS";

fs::path record_file() {
  return fs::path(HAPBENCH_TEST_DATA) / "numbers.txt";
}

NumbersByName read_record() {
  NumbersByName record;
  for (const std::string& text : lines_of(read_file(record_file()))) {
    std::istringstream words(text);
    std::string name;
    words >> name;
    words >> record[name].state >> record[name].tables;
  }
  return record;
}

bool is_command(const std::string& name) {
  return name.find(':') != std::string::npos;
}

void renew(bool of_commands, const NumbersByName& found) {
  NumbersByName record = read_record();
  std::erase_if(record, [&](const auto& line) { return is_command(line.first) == of_commands; });
  record.insert(found.begin(), found.end());
  std::string text;
  for (const auto& [name, numbers] : record) text += name + " " + numbers.state + " " + numbers.tables + "\n";
  write_plainly(record_file(), text);
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
    }
  }
  numbers.tables = hash_text(hash.value());
  return numbers;
}

void expect_recorded(bool of_commands, const NumbersByName& found) {
  ASSERT_FALSE(found.empty());
  if (std::getenv(kRenew) != nullptr) {
    renew(of_commands, found);
    return;
  }
  NumbersByName record = read_record();
  std::erase_if(record, [&](const auto& line) { return is_command(line.first) != of_commands; });
  EXPECT_EQ(differences(found, record), "")
      << "other numbers than those on record; if they are meant to change, renew " << record_file() << " with "
      << kRenew << "=1, and say in the commit which change and why.";
}

}  // namespace hapbench::test
