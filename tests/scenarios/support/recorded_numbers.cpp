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
  std::map<std::string, std::vector<std::string>> columns;
  for (const std::string& text : lines_of(read_file(record_file()))) {
    std::istringstream words(text);
    std::string name, file, word;
    words >> name >> file;
    if (name == "columns") columns[file].clear();
    for (std::size_t i = 0; words >> word; ++i) {
      if (name == "columns")
        columns[file].push_back(word);
      else
        record[name][file][columns[file].at(i)] = word;
    }
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
  std::map<std::string, std::string> headings;
  for (const auto& [name, files] : record) {
    for (const auto& [file, columns] : files) {
      std::string heading = "columns " + file, hashes = name + " " + file;
      for (const auto& [column, hash] : columns) {
        heading += " " + column;
        hashes += " " + hash;
      }
      if (heading != headings[file]) text += heading + "\n";
      headings[file] = heading;
      text += hashes + "\n";
    }
  }
  write_plainly(record_file(), text);
}

using Hashes = std::map<std::string, std::map<std::string, Hash64>>;

void add_table(std::map<std::string, Hash64>& hashes, const std::string& text) {
  const std::vector<std::string> lines = lines_of(text);
  const std::vector<std::string> columns = lines.empty() ? std::vector<std::string>() : cells_of(lines[0]);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = cells_of(lines[i]);
    for (std::size_t j = 0; j < cells.size(); ++j) {
      double number = 0.0;
      const auto [end, error] = std::from_chars(cells[j].data(), cells[j].data() + cells[j].size(), number);
      if (error == std::errc() && end == cells[j].data() + cells[j].size()) hashes[columns.at(j)].real(number);
    }
  }
}

void add_numbers(Hash64& hash, const Json& json) {
  if (json.is_number()) hash.real(json.get<double>());
  if (!json.is_structured()) return;
  for (const Json& value : json) add_numbers(hash, value);
}

/// "file column" with the hash, for all of a name.
std::map<std::string, std::string> flat(const NumbersByName& numbers, const std::string& name) {
  std::map<std::string, std::string> all;
  const auto found = numbers.find(name);
  if (found == numbers.end()) return all;
  for (const auto& [file, columns] : found->second)
    for (const auto& [column, hash] : columns) all[file + " " + column] = hash;
  return all;
}

/// What differs, a line each.
std::string differences(const NumbersByName& found, const NumbersByName& record) {
  std::string text;
  NumbersByName names = found;
  names.insert(record.begin(), record.end());
  for (const auto& [name, unused] : names) {
    const auto now = flat(found, name), before = flat(record, name);
    for (const auto& [place, hash] : now) {
      const auto known = before.find(place);
      if (known == before.end() || known->second != hash)
        text += "  " + name + ": " + place + (known == before.end() ? " is not on record\n" : " has OTHER numbers\n");
    }
    for (const auto& [place, hash] : before)
      if (!now.contains(place)) text += "  " + name + ": " + place + " is on record only\n";
  }
  return text;
}

}  // namespace

RecordedNumbers numbers_below(const fs::path& directory) {
  RecordedNumbers numbers;
  Hashes hashes;
  for (const auto& [name, contents] : files_below(directory)) {
    const std::string file = fs::path(name).filename().string();
    if (file.ends_with(".csv")) {
      add_table(hashes[file], contents);
    } else if (file == "summary.json") {
      const Json summary = Json::parse(contents);
      for (const auto& [group, metrics] : summary.at("metrics").items()) add_numbers(hashes[file][group], metrics);
      if (name == file) numbers[file]["state_hash"] = summary.at("state_hash");
    }
  }
  // Half of each hash: a change that it does not see has a chance of 2^-32.
  for (const auto& [file, columns] : hashes)
    for (const auto& [column, hash] : columns) numbers[file][column] = hash_text(hash.value()).substr(0, 8);
  return numbers;
}

void expect_recorded(bool of_commands, const NumbersByName& found, bool some) {
  ASSERT_FALSE(found.empty());
  if (std::getenv(kRenew) != nullptr) {
    renew(of_commands, found);
    return;
  }
  NumbersByName record = read_record();
  std::erase_if(record, [&](const auto& line) {
    return is_command(line.first) != of_commands || (some && !found.contains(line.first));
  });
  EXPECT_EQ(differences(found, record), "")
      << "other numbers than those on record; if they are meant to change, renew " << record_file() << " with "
      << kRenew << "=1, and say in the commit which change and why.";
}

}  // namespace hapbench::test
