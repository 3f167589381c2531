#include "scenarios/import/import_stroke.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/input/motion_file.hpp"
#include "sim/core/random.hpp"
#include "tests/scenarios/import/recordings.hpp"

namespace hapbench::import_stroke_test {
namespace {

using Eigen::Quaterniond;
using test::imported;
using test::refusal;
using test::time_and_position;

constexpr const char* kStraight = "0,0,0,0\n0.01,0.001,0,0\n0.02,0.002,0,0\n0.03,0.003,0,0\n";

TEST(ImportStroke, TakesColumnsByNumberNameAndAlone) {
  const std::string rows = "7,0,1,2,3\n8,1,1.5,2,3\n";
  ImportOptions options = time_and_position();
  options.most_speed = 10.0;
  set_column(options, "time", {"2"});
  set_column(options, "position", {"3"});
  EXPECT_EQ(imported(rows, options).samples.position[1], Vec3(1.5, 2, 3));
  set_column(options, "time", {"t"});
  set_column(options, "position", {"x"});
  EXPECT_EQ(imported("n,t,x,y,z\n" + rows, options).samples.position[1], Vec3(1.5, 2, 3));
  options.columns.erase("position");
  for (const auto& [quantity, name] : {std::pair{"px", "z"}, {"py", "x"}, {"pz", "4"}})
    set_column(options, quantity, {name});
  EXPECT_EQ(imported("n;t;x;y;z\n7;0;1;2;3\n8;1;1.5;2;3\n", options).samples.position[1], Vec3(3, 1.5, 2));
}

TEST(ImportStroke, NamesTheColumnsThatTheFileHas) {
  ImportOptions options = time_and_position();
  set_column(options, "position", {"tip_y"});
  EXPECT_EQ(refusal("t,tip_x,tip_yy,tip_z\n0,0,0,0\n1,0,0,0\n", options),
            "rec.csv: columns: position: got \"tip_y\"; nearest valid name: \"tip_x\"; the file has 1 t, 2 tip_x, 3 "
            "tip_yy, 4 tip_z");
  set_column(options, "position", {"3"});
  EXPECT_EQ(refusal(kStraight, options), "rec.csv: columns: position: takes columns 3 ... 5; the file has 1, 2, 3, 4");
}

TEST(ImportStroke, PutsUnitsAndFramesRight) {
  ImportOptions options = time_and_position();
  set_column(options, "force", {"5"});
  set_scale(options, "time", 1e-6);
  set_scale(options, "position", 1e-3);
  set_scale(options, "force", 9.81);
  set_frame(options, {"x", "-z", "y"});
  options.shift = {0.5, 0, 0};
  options.force_by_tool = true;
  const auto [stroke, report] = imported("5e6,1,2,3,1,0,2\n5.1e6,1,2,4,1,0,2\n", options);
  EXPECT_NEAR((stroke.position[1] - Vec3(0.501, -0.004, 0.002)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((stroke.force[0] - Vec3(-9.81, 19.62, 0)).norm(), 0.0, 1e-14);
  EXPECT_EQ(stroke.time[0], 0.0);
  EXPECT_NEAR(stroke.time[1], 0.1, 1e-12);
  EXPECT_EQ(report.clock.first, 5.0);
}

/// The same turns written in every way are the same stroke.
TEST(ImportStroke, ReadsEveryWayToWriteAnOrientation) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Quaterniond q(Eigen::AngleAxisd(3.0 * random.uniform(), random.direction()));
    const Vec3 tip_axis = random.direction();
    const Eigen::AngleAxisd turn(q);
    const Mat3 m = q.toRotationMatrix();
    const auto with = [&](const char* kind, const std::vector<double>& numbers) {
      ImportOptions options = time_and_position();
      set_orientation(options, kind);
      set_column(options, "orientation", {"5"});
      options.tip_axis = tip_axis;
      std::string cells;
      for (const double number : numbers) cells += fmt::format(",{}", number);
      return imported("0,0,0,0" + cells + "\n1,0,0,0" + cells + "\n", options).samples.turn[1];
    };
    std::vector<double> rows;
    for (int r = 0; r < 3; ++r) rows.insert(rows.end(), {m(r, 0), m(r, 1), m(r, 2)});
    const Quaterniond expected = with("quat_wxyz", {q.w(), q.x(), q.y(), q.z()});
    EXPECT_NEAR((expected * Vec3(0, 0, -1) - q * tip_axis).norm(), 0.0, 1e-14) << "the axis is the tip's direction";
    EXPECT_LT(with("quat_xyzw", {q.x(), q.y(), q.z(), q.w()}).angularDistance(expected), 1e-14);
    EXPECT_LT(with("quat_xyzw", {-q.x(), -q.y(), -q.z(), -q.w()}).angularDistance(expected), 1e-14);
    EXPECT_LT(
        with("axis_angle", {turn.axis().x(), turn.axis().y(), turn.axis().z(), turn.angle()}).angularDistance(expected),
        1e-7);
    EXPECT_LT(with("matrix", rows).angularDistance(expected), 1e-7);
  }
}

TEST(ImportStroke, RefusesBadRowsWithTheirLines) {
  const std::string start = "t,x,y,z\n0,0,0,0\n";
  const std::string line = "rec.csv, line 3: ";
  EXPECT_EQ(refusal(start + "0.1,nan,0,0\n"), line + "column 2 x: got \"nan\"; allowed: a finite number");
  EXPECT_EQ(refusal(start + "0.1,,0,0\n"), line + "column 2 x: got \"\"; allowed: a finite number");
  EXPECT_EQ(refusal(start + "0.1,0,0\n"), line + "got 3 values; allowed: 4");
  EXPECT_EQ(refusal(start + "0,0,0,0\n"), line + "got time 0 s after 0 s; allowed: increasing times");
  EXPECT_EQ(refusal(start + "-1,0,0,0\n"), line + "got time -1 s after 0 s; allowed: increasing times");
  EXPECT_EQ(refusal(start + "0.1,1,0,0\n"),
            line + "got a jump of 1000 mm in 100 ms, 10 m/s; allowed: 5 m/s (is the scale right?)");
  EXPECT_EQ(refusal(start + "0.1,0,0,0\n0.2,0,0,0\n0.3,0,0,0\n1.5,0,0,0\n"),
            "rec.csv, line 5: a gap of 1.2 s follows; allowed: 0.5 s (--max-gap)");
  EXPECT_EQ(refusal("0,0,0,0\n"), "rec.csv: 1 usable samples of 1; allowed: at least 2");
  EXPECT_EQ(refusal(""), "rec.csv: no samples; allowed: a line for each");
}

TEST(ImportStroke, RefusesOrientationsThatAreNone) {
  ImportOptions options = time_and_position();
  set_column(options, "orientation", {"5"});
  const auto refused = [&](const char* kind, const std::string& cells) {
    set_orientation(options, kind);
    return refusal("0,0,0,0," + cells + "\n1,0,0,0," + cells + "\n", options);
  };
  EXPECT_NE(refused("quat_wxyz", "0.9,0,0,0").find("line 1: got a quaternion of norm 0.9; allowed: 1 within 0.001"),
            std::string::npos);
  EXPECT_EQ(refused("quat_wxyz", "0.9991,0,0,0"), "");
  EXPECT_NE(refused("axis_angle", "0,0,0,1").find("got a turn's axis of norm 0"), std::string::npos);
  EXPECT_EQ(refused("axis_angle", "0,0,0,0"), "") << "no turn needs no axis";
  EXPECT_NE(refused("matrix", "1,0,0,0,1,0,0,0,-1").find("no rotation"), std::string::npos);
  EXPECT_NE(refused("axis", "0,0,0").find("axis of length 0"), std::string::npos);
}

TEST(ImportStroke, LeavesBadRowsOutWhereAsked) {
  ImportOptions options = time_and_position();
  options.skip_bad_rows = true;
  const auto [stroke, report] =
      imported("0,0,0,0\n0.01,x,0,0\n0.02,0.002,0,0\n0.015,0,0,0\n0.03,9,0,0\n0.04,0.004,0,0\n", options);
  EXPECT_EQ(report.rows_read, 6u);
  EXPECT_EQ(report.rows_left_out, 3u);
  ASSERT_EQ(stroke.size(), 3u);
  EXPECT_EQ(stroke.position[2].x(), 0.004);
  EXPECT_EQ(report.warnings.size(), 4u) << "their number and each with its line";
}

TEST(ImportStroke, KeepsARegularClockAndEvensAnIrregularOne) {
  const auto regular = imported(kStraight, time_and_position());
  EXPECT_FALSE(regular.report.resampled);
  EXPECT_NEAR(regular.report.rate, 100.0, 1e-9);
  const std::string irregular = "1,0,0,0\n1.008,0.0008,0,0\n1.02,0.002,0,0\n1.03,0.003,0,0\n1.04,0.004,0,0\n";
  const auto [stroke, report] = imported(irregular, time_and_position());
  EXPECT_TRUE(report.resampled);
  EXPECT_EQ(report.rate, 100.0);
  ASSERT_EQ(stroke.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(stroke.time[i], 0.01 * static_cast<double>(i), 1e-15);
    EXPECT_NEAR(stroke.position[i].x(), 0.1 * stroke.time[i], 1e-12) << "a straight way stays one";
  }
}

TEST(ImportStroke, TurnsAtConstantSpeedBetweenSamples) {
  ImportOptions options = time_and_position();
  set_orientation(options, "axis_angle");
  set_column(options, "orientation", {"5"});
  options.rate = 8.0;
  options.longest_gap = 2.0;
  const auto stroke = imported("0,0,0,0,0,1,0,0\n1,0,0,0,0,1,0,1.2\n", options).samples;
  ASSERT_EQ(stroke.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_NEAR(stroke.turn[i].angularDistance(stroke.turn[0]), 0.15 * static_cast<double>(i), 1e-12);
}

TEST(ImportStroke, SmoothingKeepsPolynomialsAndSaysWhatItDid) {
  ImportOptions options = time_and_position();
  options.smoothing = Smoothing{7, 3};
  std::string cubic, noisy;
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const double t = 0.01 * i, x = 0.01 + t * (0.02 - t * (0.1 - t));
    cubic += fmt::format("{},{},{},0\n", t, x, -x);
    noisy += fmt::format("{},{},{},0\n", t, x + 1e-4 * random.uniform(), 0.0);
  }
  const auto kept = imported(cubic, options);
  EXPECT_LT(kept.report.smoothing->position_largest, 1e-14);
  EXPECT_NEAR(kept.report.smoothing->angle_largest, 0.0, 1e-7);
  const auto smoothed = imported(noisy, options);
  EXPECT_GT(smoothed.report.smoothing->position_rms, 1e-5);
  EXPECT_LT(smoothed.report.smoothing->position_largest, 1e-4);
  EXPECT_GE(smoothed.report.smoothing->position_largest, smoothed.report.smoothing->position_rms);
  for (const Smoothing wrong : {Smoothing{4, 2}, Smoothing{7, 7}, Smoothing{41, 2}, Smoothing{1, 0}}) {
    options.smoothing = wrong;
    EXPECT_EQ(refusal(cubic, options).find("smooth: got"), 0u) << wrong.window;
  }
}

TEST(ImportStroke, MeasuresTheQuantum) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += fmt::format("{},{:.2f},{:.17g},0\n", 0.01 * i, 3.0 * std::sin(i), std::sin(i));
  ImportOptions options = time_and_position();
  set_scale(options, "position", 1e-3);
  const ImportReport report = imported(text, options).report;
  EXPECT_NEAR(report.quantum[0].value_or(0.0), 1e-5, 1e-12);
  EXPECT_FALSE(report.quantum[1]);
  EXPECT_FALSE(report.quantum[2]);
}

/// What comes out is what stroke_in takes.
TEST(ImportStroke, WritesStrokesThatScenariosRead) {
  ImportOptions options = time_and_position();
  set_orientation(options, "axis");
  set_column(options, "orientation", {"5"});
  set_column(options, "force", {"8"});
  const auto stroke = imported("0,0,0,0,0,0,-2,1,2,3\n0.1,0.01,0,0,0,1,-1,2,3,4\n", options).samples;
  const std::string text = stroke_text(stroke);
  const auto [motion, force] = stroke_in(text, "stroke.csv");
  EXPECT_NEAR((motion.axis_at(0.1) - Vec3(0, 1, -1).normalized()).norm(), 0.0, 1e-15);
  EXPECT_EQ(motion.position_at(0.1), Vec3(0.01, 0, 0));
  ASSERT_TRUE(force);
  EXPECT_NEAR((*force->at(0.05) - Vec3(1.5, 2.5, 3.5)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(force->at(0.2)) << "nothing was measured then";
}

}  // namespace
}  // namespace hapbench::import_stroke_test
