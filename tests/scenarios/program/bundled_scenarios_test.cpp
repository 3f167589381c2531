#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <regex>
#include <set>

#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/recorded_numbers.hpp"
#include "tests/support/scale.hpp"

/// Every scenario that comes with the program, run by the program, and the numbers on record.
namespace hapbench::bundled_scenarios_test {
namespace {

namespace fs = std::filesystem;
using test::lines_of;
using test::ProgramRun;

/// Arguments that make a scenario of many steps a matter of milliseconds; none for the others. The tasks of the thesis
/// touch the block within these steps.
std::vector<std::string> shortened(const Scenario& scenario) {
  constexpr std::int64_t kSteps = 1500;
  if (scenario.time.steps <= kSteps) return {};
  std::vector<std::string> arguments = {
      "--set",
      R"(expect={"outcome": ["completes", "leaves_hole", "tool_horizontal", "not_dragged", "stuck", "no_contact", "lost_contact", "went_through", "diverges"]})",
      "--set", fmt::format("time={{\"step_s\": {}, \"steps\": {}}}", scenario.time.step, kSteps)};
  if (std::holds_alternative<TrackingHandFields>(scenario.hand))
    arguments.insert(arguments.end(), {"--set", "hand.trials=1", "--set", "hand.subjects=[{}]"});
  return arguments;
}

/// The scenarios that are run in full: all of them. Under AddressSanitizer one of 10^5 steps takes minutes and shows
/// nothing that its first steps do not.
std::vector<BundledScenario> scenarios_in_full() {
  std::vector<BundledScenario> scenarios = bundled_scenarios();
  constexpr std::int64_t kMostSanitizedSteps = 10'000;
  if (HAPBENCH_TEST_SANITIZED != 0)
    std::erase_if(scenarios, [](const BundledScenario& bundled) {
      return load_scenario(bundled.file).scenario.time.steps > kMostSanitizedSteps;
    });
  return scenarios;
}

/// In one process.
ProgramRun run_in_full(const std::vector<BundledScenario>& scenarios, const fs::path& out) {
  std::vector<std::string> arguments = {"run", "--out", out.string()};
  for (const BundledScenario& bundled : scenarios) arguments.push_back(bundled.file.string());
  return test::hapbench(arguments);
}

/// The runs are made once for all tests of the suite.
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
    const Json summary = Json::parse(test::read_file(*directory_ / "full" / bundled.name / "summary.json"));
    EXPECT_EQ(summary["expected"], true) << bundled.name;
    EXPECT_EQ(summary["name"], bundled.name) << "the name in the file is the file's";
    EXPECT_EQ(summary["work"]["allocations"], 0) << bundled.name;
  }
}

TEST_F(BundledScenarios, HaveTheNumbersOnRecord) {
  test::NumbersByName numbers;
  for (const BundledScenario& bundled : in_full_)
    numbers[bundled.name] = test::numbers_below(*directory_ / "full" / bundled.name);
  test::expect_recorded(false, numbers, in_full_.size() < bundled_scenarios().size());
}

/// Warnings, each once, without the file that a warning about a field names.
std::set<std::string> warnings_in(const std::string& err) {
  static const std::regex file(R"(warning: /.*?\.json: )");
  std::set<std::string> warnings;
  for (const std::string& line : lines_of(err)) {
    if (line.starts_with("hapbench: warning: ")) warnings.insert(std::regex_replace(line, file, "warning: "));
  }
  return warnings;
}

/// The summary without what brute force counts differently.
std::string summary_without_work(Json summary) {
  summary.erase("work");
  return summary.dump();
}

// Another process, the scenario that the run wrote, the scalar build and brute force in place of skips: none of them
// changes a byte. Scenarios of many steps are shortened; but for a soak it is every eighth, since brute force takes its
// time.
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
    if (turn++ % 8 != 0 && !test::soaks()) {
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
    // Under the scenario's name, which becomes the directory's, and as deep, since paths in it are relative.
    arguments.push_back((effective / (bundled.name + ".json")).string());
    fs::create_hard_link(out / "scenario.effective.json", arguments.back());
  }
  const ProgramRun run = test::run_program(test::hapbench_scalar_program(), arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(warnings_in(run.err), warnings);
  test::expect_same_files(first, again, {"summary.json", "timing.json"});
  std::uint64_t tested_first = 0, tested_again = 0, skipped = 0;
  for (const BundledScenario& bundled : compared) {
    const Json a = Json::parse(test::read_file(first / bundled.name / "summary.json")),
               b = Json::parse(test::read_file(again / bundled.name / "summary.json"));
    EXPECT_EQ(summary_without_work(a), summary_without_work(b)) << bundled.name;
    EXPECT_EQ(b["work"]["steps_skipped"], 0) << bundled.name;
    EXPECT_EQ(b["work"]["lists_rebuilt"], 0) << bundled.name;
    EXPECT_EQ(b["work"]["allocations"], a["work"]["allocations"]) << bundled.name;
    tested_first += a["work"]["points_tested"].get<std::uint64_t>();
    tested_again += b["work"]["points_tested"].get<std::uint64_t>();
    skipped += a["work"]["steps_skipped"].get<std::uint64_t>();
  }
  // There was something to skip.
  EXPECT_LT(20 * tested_first, tested_again);
  EXPECT_GT(skipped, 0u);
}

// The results of commands besides `run`, and of every algorithm on scenes of every kind.
TEST(Commands, HaveTheNumbersOnRecord) {
  const char* kShort = "time={\"step_s\":0.0005,\"steps\":600}";
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
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
      {"stress:sets", {"stress", "--count", "3000"}},
  };
  const test::TemporaryDirectory directory;
  test::NumbersByName numbers;
  for (const auto& [name, words] : commands) {
    std::vector<std::string> arguments = words;
    const fs::path out = directory / name;
    arguments.insert(arguments.end(), {"--out", out.string(), "--quiet"});
    const ProgramRun run = test::hapbench(arguments);
    // 3: a run that diverges, as summation does in places.
    EXPECT_TRUE(run.status == 0 || run.status == 3) << name << ": " << run.err;
    numbers[name] = test::numbers_below(out);
  }
  test::expect_recorded(true, numbers);
}

}  // namespace
}  // namespace hapbench::bundled_scenarios_test
