#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <regex>

#include "scenarios/description/bundled_scenarios.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/recorded_hashes.hpp"
#include "tests/scenarios/support/shortened.hpp"

/// Every scenario that comes with the program, run by the program.
namespace hapbench::bundled_scenarios_test {
namespace {

namespace fs = std::filesystem;
using test::lines_of;
using test::ProgramRun;

/// The scenarios run once in full and once shortened, for all tests of the suite.
class BundledScenarios : public testing::Test {
 protected:
  static void SetUpTestSuite() { directory_ = std::make_unique<test::TemporaryDirectory>(); }
  static void TearDownTestSuite() { directory_.reset(); }

  static fs::path directory(const std::string& name) { return *directory_ / name; }

  /// All of them in full, in one process.
  static const ProgramRun& full_run() {
    static const ProgramRun run = [] {
      std::vector<std::string> arguments = {"run", "--out", directory("full").string()};
      for (const BundledScenario& bundled : bundled_scenarios()) arguments.push_back(bundled.file.string());
      return test::hapbench(arguments);
    }();
    return run;
  }

  /// What they print as warnings, by their names.
  static std::map<std::string, std::string> run_shortened(const std::string& name, const fs::path& program) {
    std::map<std::string, std::string> warnings;
    for (const BundledScenario& bundled : bundled_scenarios()) {
      std::vector<std::string> arguments = {"run", bundled.file.string(), "--out",
                                            (directory(name) / bundled.name).string()};
      const std::vector<std::string> more = test::shortened(bundled);
      arguments.insert(arguments.end(), more.begin(), more.end());
      const ProgramRun run = test::run_program(program, arguments);
      EXPECT_EQ(run.status, 0) << bundled.name << ": " << run.err;
      warnings[bundled.name] = run.err;
    }
    return warnings;
  }

  /// In directory("short").
  static const std::map<std::string, std::string>& shortened_runs() {
    static const auto warnings = run_shortened("short", test::hapbench_program());
    return warnings;
  }

 private:
  static std::unique_ptr<test::TemporaryDirectory> directory_;
};

std::unique_ptr<test::TemporaryDirectory> BundledScenarios::directory_;

TEST_F(BundledScenarios, EndAsTheirExpectBlocksSayAndAllocateNothingInTheirStepLoops) {
  const ProgramRun& run = full_run();
  EXPECT_EQ(run.status, 0) << run.err;
  for (const std::string& line : test::lines_of(run.err)) {
    EXPECT_TRUE(line.starts_with("hapbench: warning: ") || line.starts_with("hapbench: about ")) << line;
  }
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const Json summary = Json::parse(test::read_file(directory("full") / bundled.name / "summary.json"));
    EXPECT_EQ(summary["expected"], true) << bundled.name;
    EXPECT_EQ(summary["name"], bundled.name) << "the name in the file is the file's";
    EXPECT_EQ(summary["work"]["allocations"], 0) << bundled.name;
  }
}

TEST_F(BundledScenarios, HaveTheResultsOnRecord) {
  full_run();
  std::map<std::string, std::string> hashes;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    hashes["scenario: " + bundled.name] = test::hash_of_results(directory("full") / bundled.name);
  }
  test::expect_recorded("scenario:", hashes);
}

/// Warnings about fields name the file that has them, whatever characters its path has.
std::string without_files(const std::string& err) {
  static const std::regex file(R"(warning: /[^\n]*?\.json: )");
  return std::regex_replace(err, file, "warning: ");
}

/// Another process, and the scenario that the run wrote: neither changes a byte.
TEST_F(BundledScenarios, GiveTheSameBytesAgainFromTheirEffectiveScenarios) {
  for (const auto& [name, warnings] : shortened_runs()) {
    const ProgramRun again = test::hapbench({"run", (directory("short") / name / "scenario.effective.json").string(),
                                             "--out", (directory("again") / name).string()});
    EXPECT_EQ(again.status, 0) << name << ": " << again.err;
    EXPECT_EQ(without_files(again.err), without_files(warnings)) << name;
  }
  test::expect_same_files(directory("short"), directory("again"), {"timing.json"});
}

TEST_F(BundledScenarios, GiveTheSameBytesInTheScalarBuild) {
  shortened_runs();
  run_shortened("scalar", test::hapbench_scalar_program());
  test::expect_same_files(directory("short"), directory("scalar"), {"timing.json"});
}

TEST(Trajectory, HasTheColumnsOfTheDesignInTheirOrder) {
  const test::TemporaryDirectory directory;
  for (const char* scenario : {"single_spring", "peg_in_hole_2d_mean", "poke_plane"}) {
    test::hapbench({"run", scenario, "--out", (directory / scenario).string()});
    const auto rows = lines_of(test::read_file(directory.path() / scenario / "trajectory.csv"));
    EXPECT_EQ(
        rows[0],
        "step,time_s,px_m,py_m,pz_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,axis_x,axis_y,axis_z,"
        "fx_N,fy_N,fz_N,fspring_x_N,fspring_y_N,fspring_z_N,fmeas_x_N,fmeas_y_N,fmeas_z_N,fin_x_N,fin_y_N,fin_z_N,"
        "hx_m,hy_m,hz_m,colliding,rendered,depth_max_m,ratio_min,ratio_max")
        << scenario;
    for (const std::string& row : rows) ASSERT_EQ(test::cells_of(row).size(), 31u) << row;
    const Json summary = Json::parse(test::read_file(directory.path() / scenario / "summary.json"));
    EXPECT_EQ(rows.size(), 1 + summary["steps"].get<std::size_t>());
  }
}

/// The shortest decimals that read back as the same double, however they are spelt: none with one digit less does.
void expect_shortest(const std::string& cell) {
  const double value = test::number_in(cell);
  const auto digits = static_cast<int>(std::count_if(cell.begin(), std::find(cell.begin(), cell.end(), 'e'),
                                                     [](char c) { return c >= '0' && c <= '9'; }));
  for (int precision = 1; precision < 17; ++precision) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*e", precision - 1, value);
    if (std::strtod(text, nullptr) != value) continue;
    // Zeros before the first digit or after the last are no digits of the number.
    EXPECT_LE(precision, digits) << cell;
    std::string significant(cell.substr(0, cell.find('e')));
    std::erase_if(significant, [](char c) { return c == '.' || c == '-'; });
    significant.erase(0, std::min(significant.find_first_not_of('0'), significant.size()));
    while (significant.ends_with('0')) significant.pop_back();
    EXPECT_LE(significant.size(), static_cast<std::size_t>(precision)) << cell;
    return;
  }
}

TEST(Trajectory, HasTheShortestNumbersThatReadBackTheSame) {
  const test::TemporaryDirectory directory;
  test::hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--out", (directory / "out").string()});
  const auto rows = lines_of(test::read_file(directory / "out/trajectory.csv"));
  ASSERT_GT(rows.size(), 100u);
  for (std::size_t i = 1; i < rows.size(); i += 7) {
    for (const std::string& cell : test::cells_of(rows[i])) {
      if (!cell.empty()) expect_shortest(cell);
    }
  }
}

}  // namespace
}  // namespace hapbench::bundled_scenarios_test
