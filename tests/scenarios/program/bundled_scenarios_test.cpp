#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "scenarios/description/bundled_scenarios.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/shortened.hpp"

/// Every scenario that comes with the program, run by the program.
namespace hapbench {
namespace {

namespace fs = std::filesystem;
using test::lines_of;
using test::ProgramRun;

TEST(BundledScenarios, EndAsTheirExpectBlocksSayAndAllocateNothingInTheirStepLoops) {
  const test::TemporaryDirectory directory;
  std::vector<std::string> arguments = {"run", "--out", directory.path().string()};
  for (const BundledScenario& bundled : bundled_scenarios()) arguments.push_back(bundled.file.string());
  test::ProgramOptions options;
  options.patience_s = 280.0;
  const ProgramRun run = test::run_program(test::hapbench_program(), arguments, options);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const Json summary = Json::parse(test::read_file(directory.path() / bundled.name / "summary.json"));
    EXPECT_EQ(summary["expected"], true) << bundled.name;
    EXPECT_EQ(summary["name"], bundled.name) << "the name in the file is the file's";
    EXPECT_EQ(summary["work"]["allocations"], 0) << bundled.name;
  }
}

void run_shortened(const BundledScenario& bundled, const fs::path& directory, const fs::path& program) {
  std::vector<std::string> arguments = {"run", bundled.file.string(), "--out", (directory / bundled.name).string()};
  const std::vector<std::string> more = test::shortened(bundled);
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramRun run = test::run_program(program, arguments);
  EXPECT_EQ(run.status, 0) << bundled.name << ": " << run.err;
}

TEST(BundledScenarios, GiveTheSameBytesTwice) {
  const test::TemporaryDirectory directory;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    run_shortened(bundled, directory / "a", test::hapbench_program());
    run_shortened(bundled, directory / "b", test::hapbench_program());
  }
  test::expect_same_files(directory / "a", directory / "b", {"timing.json"});
}

TEST(BundledScenarios, GiveTheSameBytesInTheScalarBuild) {
  const test::TemporaryDirectory directory;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    run_shortened(bundled, directory / "simd", test::hapbench_program());
    run_shortened(bundled, directory / "scalar", test::hapbench_scalar_program());
  }
  test::expect_same_files(directory / "simd", directory / "scalar", {"timing.json"});
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
}  // namespace hapbench
