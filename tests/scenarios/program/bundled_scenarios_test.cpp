#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/support/scale.hpp"

/// Tests every bundled scenario, run by the program, against stored numbers.
namespace hapbench::bundled_scenarios_test {
namespace {

namespace fs = std::filesystem;
using test::lines_of;
using test::ProgramRun;
using test::read_file;

// Format of the stored numbers in tests/data/numbers.txt: for each bundled scenario and for some commands a line
// "name file" for each file with numbers, and below it an indented line for each column of the file:
//
//     column count last largest hash
//
// A column line gives the count of the numbers, the first digits of the last number and of the number with the largest
// magnitude, and a hash of all numbers. The hash shows whether any number has changed. The digits show in a diff which
// numbers have changed. Texts are not included. The numbers are the same on every processor and with every compiler.
//
// After a change that is meant to change numbers, this command updates the file, which is committed with the change:
//
//     HAPBENCH_RENEW_NUMBERS=1 build/release/bin/program_test --gtest_filter='*OnRecord*'

/// Stored text of the numbers of each column, by file and column. Files with the same name in several folders of a
/// result count as one file. For summary.json, groups of metrics replace the columns; a single run also has the
/// state_hash.
using RecordedNumbers = std::map<std::string, std::map<std::string, std::string>>;
using NumbersByName = std::map<std::string, RecordedNumbers>;

constexpr const char* kRenew = "HAPBENCH_RENEW_NUMBERS";

fs::path record_file() {
  return fs::path(HAPBENCH_TEST_DATA) / "numbers.txt";
}

NumbersByName read_record() {
  NumbersByName record;
  std::string name, file;
  for (const std::string& text : lines_of(read_file(record_file()))) {
    std::istringstream words(text);
    if (!text.starts_with(' ')) {
      words >> name >> file;
      continue;
    }
    std::string column;
    words >> column >> std::ws;
    std::getline(words, record[name][file][column]);
  }
  return record;
}

bool is_command(const std::string& name) {
  return name.find(':') != std::string::npos;
}

/// Stores the numbers found. `some`: keeps the stored numbers of names that were not found.
void renew(bool of_commands, const NumbersByName& found, bool some) {
  NumbersByName record = read_record();
  std::erase_if(record, [&](const auto& line) {
    return is_command(line.first) == of_commands && (!some || found.contains(line.first));
  });
  record.insert(found.begin(), found.end());
  std::string text;
  for (const auto& [name, files] : record) {
    for (const auto& [file, columns] : files) {
      text += name + " " + file + "\n";
      for (const auto& [column, numbers] : columns) text += "  " + column + " " + numbers + "\n";
    }
  }
  test::write_plainly(record_file(), text);
}

/// Returns the first four digits of a number, such as "-1.234e-03". The digits are cut off the shortest text that reads
/// back as the same number, and not rounded, so that every compiler prints the same digits.
std::string first_digits(double number) {
  std::array<char, 32> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::scientific);
  EXPECT_EQ(error, std::errc());
  std::string text(buffer.data(), end);
  const std::size_t point = text.find('.'), exponent = text.find('e');
  constexpr std::size_t kDecimals = 3;
  if (point != std::string::npos && exponent > point + 1 + kDecimals)
    text.erase(point + 1 + kDecimals, exponent - (point + 1 + kDecimals));
  return text;
}

/// Computes count, last number, largest magnitude and hash of the numbers of a column.
class ColumnNumbers {
 public:
  void add(double number) {
    hash_.real(number);
    ++count_;
    last_ = number;
    if (count_ == 1 || std::abs(number) > std::abs(largest_)) largest_ = number;
  }
  /// Returns the stored text: count, last number, largest number, hash.
  std::string text() const {
    // Half of the hash is stored: it misses a change with the probability 2^-32.
    const std::string hash = hash_text(hash_.value()).substr(0, 8);
    if (count_ == 0) return "0 - - " + hash;
    return fmt::format("{} {} {} {}", count_, first_digits(last_), first_digits(largest_), hash);
  }

 private:
  Hash64 hash_;
  std::size_t count_ = 0;
  double last_ = 0.0;
  double largest_ = 0.0;
};

using NumbersByColumn = std::map<std::string, ColumnNumbers>;

void add_table(NumbersByColumn& numbers, const std::string& text) {
  const std::vector<std::string> lines = lines_of(text);
  const std::vector<std::string> columns = lines.empty() ? std::vector<std::string>() : csv_cells(lines[0]);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = csv_cells(lines[i]);
    for (std::size_t j = 0; j < cells.size(); ++j) {
      double number = 0.0;
      const auto [end, error] = std::from_chars(cells[j].data(), cells[j].data() + cells[j].size(), number);
      if (error == std::errc() && end == cells[j].data() + cells[j].size()) numbers[columns.at(j)].add(number);
    }
  }
}

void add_numbers(ColumnNumbers& numbers, const Json& json) {
  if (json.is_number()) numbers.add(json.get<double>());
  if (!json.is_structured()) return;
  for (const Json& value : json) add_numbers(numbers, value);
}

/// Returns the stored texts of one scenario or command, by "file column"; empty for an unknown name.
std::map<std::string, std::string> flat(const NumbersByName& numbers, const std::string& name) {
  std::map<std::string, std::string> all;
  const auto found = numbers.find(name);
  if (found == numbers.end()) return all;
  for (const auto& [file, columns] : found->second)
    for (const auto& [column, text] : columns) all[file + " " + column] = text;
  return all;
}

/// Returns the differences between found and stored numbers, one line for each difference.
std::string differences(const NumbersByName& found, const NumbersByName& record) {
  std::string text;
  NumbersByName names = found;
  names.insert(record.begin(), record.end());
  for (const auto& [name, unused] : names) {
    const auto now = flat(found, name), before = flat(record, name);
    for (const auto& [place, numbers] : now) {
      const auto known = before.find(place);
      if (known == before.end())
        text += fmt::format("  {}: {} is not on record\n", name, place);
      else if (known->second != numbers)
        text += fmt::format("  {}: {} has OTHER numbers: {}, on record {}\n", name, place, numbers, known->second);
    }
    for (const auto& [place, numbers] : before)
      if (!now.contains(place)) text += fmt::format("  {}: {} is on record only\n", name, place);
  }
  return text;
}

/// Returns the numbers of a directory of results: from all CSV files, and the metrics from the files summary.json.
RecordedNumbers numbers_below(const fs::path& directory) {
  RecordedNumbers numbers;
  std::map<std::string, NumbersByColumn> columns_by_file;
  for (const auto& [name, contents] : test::files_below(directory)) {
    const std::string file = fs::path(name).filename().string();
    if (file.ends_with(".csv")) {
      add_table(columns_by_file[file], contents);
    } else if (file == "summary.json") {
      const Json summary = Json::parse(contents);
      for (const auto& [group, metrics] : summary.at("metrics").items())
        add_numbers(columns_by_file[file][group], metrics);
      if (name == file) numbers[file]["state_hash"] = summary.at("state_hash").get<std::string>();
    }
  }
  for (const auto& [file, columns] : columns_by_file)
    for (const auto& [column, found] : columns) numbers[file][column] = found.text();
  return numbers;
}

/// Compares numbers with the stored numbers. If `of_commands` is true, these are the numbers of commands, whose names
/// have a colon; otherwise the numbers of scenarios. Fails if a number differs or is not stored. If `some` is false,
/// also fails if a stored name is missing in `found`. The failure names file and column. If the variable kRenew is set,
/// stores the numbers instead.
void expect_recorded(bool of_commands, const NumbersByName& found, bool some = false) {
  ASSERT_FALSE(found.empty());
  if (std::getenv(kRenew) != nullptr) {
    renew(of_commands, found, some);
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

/// Returns arguments that shorten a scenario of many steps, so that its run takes milliseconds; empty for other
/// scenarios. The tasks of the thesis touch the block within these steps. With sanitizers, where brute force takes
/// 0.6 s per step, the number of steps is an eighth.
std::vector<std::string> shortened(const Scenario& scenario) {
  const std::int64_t steps = 1500 / static_cast<std::int64_t>(test::sanitized(8));
  if (scenario.time.steps <= steps) return {};
  std::vector<std::string> arguments = {
      "--set",
      R"(expect={"outcome": ["completes", "leaves_hole", "tool_horizontal", "not_dragged", "stuck", "no_contact",
          "lost_contact", "went_through", "diverges"]})",
      "--set", fmt::format(R"(time={{"step_s": {}, "steps": {}}})", scenario.time.step, steps)};
  if (std::holds_alternative<TrackingHandFields>(scenario.hand))
    arguments.insert(arguments.end(), {"--set", "hand.trials=1", "--set", "hand.subjects=[{}]"});
  return arguments;
}

/// Returns the scenarios that are run in full. Under scripts/test --all these are all scenarios. Otherwise omits the
/// studies with several subjects, which take half of the time of all scenarios; Commands.HaveTheNumbersOnRecord runs
/// one trial of each study. With AddressSanitizer, also omits scenarios of more than 10^4 steps, because they take
/// minutes and their first steps find the same errors.
std::vector<BundledScenario> scenarios_in_full() {
  std::vector<BundledScenario> scenarios = bundled_scenarios();
  constexpr std::int64_t kMostSanitizedSteps = 10'000;
  std::erase_if(scenarios, [](const BundledScenario& bundled) {
    const Scenario scenario = load_scenario(bundled.file).scenario;
    if (HAPBENCH_TEST_SANITIZED != 0 && scenario.time.steps > kMostSanitizedSteps) return true;
    const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
    return hand != nullptr && hand->subjects.size() > 1 && !test::runs_all_cases();
  });
  return scenarios;
}

/// Runs all steps of these scenarios in one process.
ProgramRun run_in_full(const std::vector<BundledScenario>& scenarios, const fs::path& out) {
  std::vector<std::string> arguments = {"run", "--out", out.string()};
  for (const BundledScenario& bundled : scenarios) arguments.push_back(bundled.file.string());
  return test::hapbench(arguments);
}

/// Fixture that makes the full runs once for all tests of the suite.
class BundledScenarios : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = std::make_unique<test::TemporaryDirectory>();
    in_full_ = scenarios_in_full();
    full_run_ = run_in_full(in_full_, *directory_ / "full");
  }
  static void TearDownTestSuite() { directory_.reset(); }

  static std::unique_ptr<test::TemporaryDirectory> directory_;
  static std::vector<BundledScenario> in_full_;
  static ProgramRun full_run_;
};

std::unique_ptr<test::TemporaryDirectory> BundledScenarios::directory_;
std::vector<BundledScenario> BundledScenarios::in_full_;
ProgramRun BundledScenarios::full_run_;

TEST_F(BundledScenarios, EndAsTheirExpectBlocksSayAndAllocateNothingInTheirStepLoops) {
  EXPECT_EQ(full_run_.status, 0) << full_run_.err;
  for (const std::string& line : lines_of(full_run_.err)) {
    EXPECT_TRUE(line.starts_with("hapbench: warning: ") || line.starts_with("hapbench: about ")) << line;
  }
  for (const BundledScenario& bundled : in_full_) {
    const Json summary = Json::parse(read_file(*directory_ / "full" / bundled.name / "summary.json"));
    EXPECT_EQ(summary["expected"], true) << bundled.name;
    EXPECT_EQ(summary["name"], bundled.name) << "the name in the file is the file's";
    EXPECT_EQ(summary["work"]["allocations"], 0) << bundled.name;
  }
}

TEST_F(BundledScenarios, HaveTheNumbersOnRecord) {
  NumbersByName numbers;
  for (const BundledScenario& bundled : in_full_)
    numbers[bundled.name] = numbers_below(*directory_ / "full" / bundled.name);
  expect_recorded(false, numbers, in_full_.size() < bundled_scenarios().size());
}

/// Returns the distinct warnings, without the file that a warning about a field names.
std::set<std::string> warnings_in(const std::string& err) {
  static const std::regex file(R"(warning: /.*?\.json: )");
  std::set<std::string> warnings;
  for (const std::string& line : lines_of(err)) {
    if (line.starts_with("hapbench: warning: ")) warnings.insert(std::regex_replace(line, file, "warning: "));
  }
  return warnings;
}

/// Returns the summary without the work counts, which differ with brute force.
std::string summary_without_work(Json summary) {
  summary.erase("work");
  return summary.dump();
}

// Checks that the second run of a scenario gives the same bytes as the first run. The second run is made by another
// process of the scalar build, with brute force instead of skips, from the effective scenario that the first run wrote.
// Scenarios of many steps are shortened. Because brute force is slow, only every 16th scenario is tested; scripts/test
// --all tests every scenario.
TEST_F(BundledScenarios, GiveTheSameBytesInTheScalarBuildWithoutSkipsFromTheirEffectiveScenarios) {
  const fs::path first = *directory_ / "first", again = *directory_ / "again",
                 effective = *directory_ / "effective" / "scenes";
  std::vector<std::string> arguments = {"run", "--no-skip", "--quiet", "--out", again.string()};
  std::set<std::string> warnings = warnings_in(full_run_.err);
  fs::create_directory(first);
  fs::create_directories(effective);
  std::vector<BundledScenario> compared;
  int turn = 0;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const auto warns_of_it = [start = "hapbench: warning: " + bundled.name + ": "](const std::string& warning) {
      return warning.starts_with(start);
    };
    if (turn++ % 16 != 0 && !test::runs_all_cases()) {
      std::erase_if(warnings, warns_of_it);
      continue;
    }
    compared.push_back(bundled);
    const fs::path out = first / bundled.name;
    const std::vector<std::string> changes = shortened(load_scenario(bundled.file).scenario);
    if (changes.empty()) {
      fs::copy(*directory_ / "full" / bundled.name, out,
               fs::copy_options::recursive | fs::copy_options::create_hard_links);
    } else {
      std::erase_if(warnings, warns_of_it);
      std::vector<std::string> words = {"run", bundled.file.string(), "--out", out.string()};
      words.insert(words.end(), changes.begin(), changes.end());
      const ProgramRun run = test::hapbench(words);
      EXPECT_EQ(run.status, 0) << bundled.name << ": " << run.err;
      warnings.merge(warnings_in(run.err));
    }
    // The file has the scenario's name, because the directory of results gets its name from the file. The file's folder
    // has the same depth as the folder of the run, because the paths in the file are relative.
    arguments.push_back((effective / (bundled.name + ".json")).string());
    fs::create_hard_link(out / "scenario.effective.json", arguments.back());
  }
  const ProgramRun run = test::run_program(test::hapbench_scalar_program(), arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(warnings_in(run.err), warnings);
  test::expect_same_files(first, again, {"summary.json", "timing.json"});
  std::uint64_t tested_first = 0, tested_again = 0, skipped = 0;
  for (const BundledScenario& bundled : compared) {
    const Json a = Json::parse(read_file(first / bundled.name / "summary.json")),
               b = Json::parse(read_file(again / bundled.name / "summary.json"));
    EXPECT_EQ(summary_without_work(a), summary_without_work(b)) << bundled.name;
    EXPECT_EQ(b["work"]["steps_skipped"], 0) << bundled.name;
    EXPECT_EQ(b["work"]["lists_rebuilt"], 0) << bundled.name;
    EXPECT_EQ(b["work"]["allocations"], a["work"]["allocations"]) << bundled.name;
    tested_first += a["work"]["points_tested"].get<std::uint64_t>();
    tested_again += b["work"]["points_tested"].get<std::uint64_t>();
    skipped += a["work"]["steps_skipped"].get<std::uint64_t>();
  }
  // Check that the skips had an effect.
  EXPECT_LT(20 * tested_first, tested_again);
  EXPECT_GT(skipped, 0u);
}

// Tests the results of commands other than `run`, and of every algorithm on scenes of every kind.
TEST(Commands, HaveTheNumbersOnRecord) {
  const char* kShort = "time={\"step_s\":0.0005,\"steps\":600}";
  // One subject in one trial, for the scenarios that scenarios_in_full() omits.
  const auto one_trial = [](const std::string& name) {
    return std::vector<std::string>{"run", name, "--set", "hand.trials=1", "--set", "hand.subjects=[{}]"};
  };
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"run:rotational_averaging", one_trial("rotational_peg_in_hole_original_averaging")},
      {"run:rotational_shaped", one_trial("rotational_peg_in_hole_shaped_stiffness")},
      {"run:vertical_averaging", one_trial("vertical_peg_in_hole_original_averaging")},
      {"run:vertical_shaped", one_trial("vertical_peg_in_hole_shaped_stiffness")},
      {"compare:peg", {"compare", "peg_in_hole_2d_shaped_stiffness"}},
      {"compare:springs", {"compare", "springs_limited_shaped_stiffness"}},
      {"compare:faces", {"compare", "parallel_faces"}},
      {"compare:rotate", {"compare", "rotate_in_hole_proxy", "--set", kShort, "--set", "rendering.reduction={}"}},
      {"compare:task1",
       {"compare", "task1_flat_binary", "--set", kShort, "--set", "record.energy=true", "--set", "record.contacts=true",
        "--set", "record.stiffness_tensor=true"}},
      {"compare:trials",
       {"compare", "rotational_peg_in_hole_original_averaging", "--set", kShort, "--set", "hand.trials=1"}},
      {"sweep:peg",
       {"sweep", "peg_in_hole_2d_shaped_stiffness", "--vary", "rendering.stiffness_N_per_m=1e3:1e5:4:log", "--vary",
        "rendering.algorithm=mean,proxy", "--vary", "integrator.type=leapfrog,rk4,implicit_midpoint"}},
      {"limit:over",
       {"limit", "single_spring", "--over", "integrator.type=leapfrog,rk4,implicit_euler", "--over",
        "rendering.damping_ratio=0,1", "--stable", "bounded"}},
      {"limit:wall", {"limit", "wall_on_handle", "--over", "rendering.damping_N_s_per_m=0.1:150:3:log"}},
      {"limit:filter",
       {"limit", "wall_on_handle", "--over", "device.velocity_filter.cutoff_Hz=20:500:3:log", "--stable", "bounded",
        "--set", R"(device.velocity_filter={"type": "low_pass", "cutoff_Hz": 100})"}},
      {"limit:servo", {"limit", "device_at_wall", "--vary", "device.servo.delay_samples", "--between", "0:60"}},
      {"limit:hole",
       {"limit", "tap_hole", "--vary", "rendering.stiffness_N_per_m", "--algorithms", "mean", "--resolution", "0.5"}},
      {"limit:mesh",
       {"limit", "drag_molar", "--vary", "rendering.stiffness_N_per_m", "--algorithms", "shaped_stiffness",
        "--resolution", "0.5"}},
      {"stress:sets", {"stress", "--count", "3000"}},
  };
  const test::TemporaryDirectory directory;
  NumbersByName numbers;
  for (const auto& [name, words] : commands) {
    std::vector<std::string> arguments = words;
    const fs::path out = directory / name;
    arguments.insert(arguments.end(), {"--out", out.string(), "--quiet"});
    const ProgramRun run = test::hapbench(arguments);
    // Status 3 is also allowed: with summation, a run diverges.
    EXPECT_TRUE(run.status == 0 || run.status == 3) << name << ": " << run.err;
    numbers[name] = numbers_below(out);
  }
  expect_recorded(true, numbers);
}

}  // namespace
}  // namespace hapbench::bundled_scenarios_test
