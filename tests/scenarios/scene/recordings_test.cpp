#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/recordings.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::recordings_test {
namespace {

// Tests recorded motions and contact traces. tests/data/golden/refused_files.txt has the errors of recorded motions.

const std::string kHeader = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n";

const std::string kQuaternions = "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n";

constexpr const char* kFile = "stroke.csv";

RecordedMotion read(const std::string& rows) {
  return parse_stroke(kHeader + rows, kFile).motion;
}

TEST(MotionFile, IsPlayedBackLinearly) {
  const RecordedMotion motion = read("0,0,0,0,0,0,-1\n2,1,2,4,0,0,-1\n");
  EXPECT_FALSE(motion.position_is_free());
  EXPECT_EQ(motion.position_at(0.5), Vec3(0.25, 0.5, 1.0));
  EXPECT_EQ(motion.position_at(-1.0), Vec3(0, 0, 0));
  EXPECT_EQ(motion.position_at(3.0), Vec3(1, 2, 4));
}

TEST(MotionFile, HasItsAxesNormalised) {
  for (const char* axis : {"0,0,-1", "0,0,-1e-9", "0,0,-7", "0,0,-1e11"}) {
    EXPECT_EQ(read(std::string("0,0,0,0,") + axis + "\n").axis_at(0.0), Vec3(0, 0, -1)) << axis;
  }
  for (const char* axis : {"1e-13,0,0", "0,1e300,0", "1e200,1e200,1e200"})
    EXPECT_THROW(read(std::string("0,0,0,0,") + axis + "\n"), InputError) << axis;
}

TEST(MotionFile, ReportsAxesOfOtherLengths) {
  std::vector<std::string> notes;
  parse_stroke(kHeader + "0,0,0,0,0,0,-1.0009\n1,0,0,0,0,0,-2\n2,0,0,0,0,0.5,0\n", kFile, &notes);
  EXPECT_EQ(notes, std::vector<std::string>{"line 3: axes were divided by their lengths, which are not 1: 2, of length "
                                            "0.5 ... 2; are they directions?"});
  parse_stroke(kHeader + "0,0,0,0,0,0,-1\n", kFile, &notes);
  EXPECT_TRUE(notes.empty());
}

/// Checks a quarter turn about x, which rotates the axis from -z to y.
TEST(MotionFileOfQuaternions, TurnsTheToolsFrameIntoTheWorlds) {
  const RecordedMotion motion =
      parse_stroke(kQuaternions + "0,1,2,3,1,0,0,0\n1,1,2,3,0.7072,0.7072,0,0\n", kFile).motion;
  EXPECT_EQ(motion.axis_at(0.0), Vec3(0, 0, -1));
  EXPECT_LE((motion.axis_at(1.0) - Vec3(0, 1, 0)).norm(), 4e-16) << "normalised";
  EXPECT_EQ(motion.position_at(0.5), Vec3(1, 2, 3));
  EXPECT_TRUE(motion.scripts_roll());
  EXPECT_NO_THROW(parse_stroke(kQuaternions + "1,0,0,0,0,1.0009,0,0\n", kFile)) << "within a thousandth";
  EXPECT_THROW(parse_stroke(kQuaternions + "1,0,0,0,0,1.0011,0,0\n", kFile), InputError);
}

const std::string kTraceHeader = "time_s,x_m,y_m,z_m,ux,uy,uz,depth_m\n";

/// Returns the message of the error of a trace with these rows; empty if the trace is accepted.
std::string refusal(const std::string& rows) {
  try {
    parse_contact_trace(kTraceHeader + rows, "t.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StrokeFile, HasColumnsInAnyOrderAndNotesOnOthers) {
  std::vector<std::string> notes;
  const Stroke stroke = parse_stroke(
      "mfz_N;qz;qy;qx;qw;temp_C;pz_m;py_m;px_m;mfx_N;mfy_N;time_s\n3;0;0;0;1;20;0,3;0,2;0,1;1;2;0\n", kFile, &notes);
  EXPECT_EQ(stroke.motion.position_at(0.0), Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(stroke.motion.axis_at(0.0), Vec3(0, 0, -1));
  ASSERT_TRUE(stroke.force);
  EXPECT_EQ(stroke.force->at(0.0), Vec3(1, 2, 3));
  EXPECT_EQ(notes, (std::vector<std::string>{"line 1: column 6 \"temp_C\" is not used",
                                             "line 2: numbers are read with a decimal comma"}));
}

TEST(TraceFile, HasContactsByTime) {
  const ContactTrace trace =
      parse_contact_trace(kTraceHeader + "0,1,2,3,0,0,-1,0.5\n0,4,5,6,1,0,0,0\n\n0.25,7,8,9,0,0.6,0.8,1e-3\n", "t.csv");
  ASSERT_EQ(trace.times.size(), 2u);
  EXPECT_EQ(trace.times[1].time, 0.25);
  EXPECT_EQ(trace.times[1].first, 2u);
  EXPECT_EQ(trace.max_contacts(), 2u);
  ASSERT_EQ(trace.contacts.size(), 3u);
  EXPECT_EQ(trace.contacts[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(trace.contacts[2].gradient, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(trace.contacts[2].depth, 1e-3);
  EXPECT_TRUE(parse_contact_trace(kTraceHeader, "t.csv").times.empty());
}

TEST(TraceFile, NormalisesRoundedGradientsAlone) {
  const double exact = 0.57735026918962573;
  const auto gradient = [](const std::string& text) {
    return parse_contact_trace(kTraceHeader + "0,0,0,0," + text + ",1\n", "t.csv").contacts[0].gradient;
  };
  EXPECT_EQ(gradient("0.57735026918962573,0.57735026918962573,0.57735026918962573"), Vec3::Constant(exact));
  EXPECT_NEAR(gradient("0.5774,0.5774,0.5774").norm(), 1.0, 1e-15);
}

TEST(StrokeFile, IsRefusedOnceWithTheNumberOfRows) {
  const auto refusal_of = [](const std::string& text) {
    const auto error = test::input_error_of([&] { parse_stroke(text, kFile); });
    return error ? std::string(error->what()) : "";
  };
  const std::string axis = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n", turn = "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n";
  EXPECT_NE(
      refusal_of(axis + "0,0,0,0,0,0,-1\n0,0,0,0,0,0,-1\n0,0,0,0,0,0,-1\n1,0,0,0,0,0,0\n")
          .find(", line 3, sample 2: got time 0 after 0; allowed: strictly increasing times (2 more rows have faults)"),
      std::string::npos);
  EXPECT_NE(
      refusal_of(turn + "0,0,0,0,2,0,0,0\n1,0,0,0,2,0,0,0\n2,0,0,0,1,0,0,0\n")
          .find(", line 2, sample 1: got a quaternion qw,qx,qy,qz of norm 2; allowed: 1 within 0.001 (1 more row has"),
      std::string::npos);
}

TEST(TraceFile, IsRefusedWithItsRow) {
  EXPECT_EQ(
      refusal("0,0,0,0,0,0,1,-1\n0,0,0,0,0,0,2,1\n0,0,0,0,0,0,1,1\n1,0,0,0,0,0,1,-1\n"),
      "t.csv, line 2, contact 1: got depth -1; allowed: >= 0, the depth of the point inside the tool (2 more rows have "
      "faults)");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,1\n0.1,0,0,0,0,0,1,1\n0.05,0,0,0,0,0,1,1\n"),
            "t.csv, line 4, contact 3: got time 0.05 after 0.1; allowed: ascending times");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1.01,1\n"),
            "t.csv, line 2, contact 1: got a gradient ux,uy,uz of length 1.01; allowed: 1 within 0.001");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,-1e-9\n"),
            "t.csv, line 2, contact 1: got depth -1e-09; allowed: >= 0, the depth of the point inside the tool");
  EXPECT_NE(refusal("0,0,0\n"), "");
  std::string many;
  for (int i = 0; i < 100'001; ++i) many += "0,0,0,0,0,0,1,1\n";
  EXPECT_EQ(refusal(many),
            "t.csv, line 100002, contact 100001: got too many contacts at time 0; allowed: at most 100000");
  EXPECT_THROW(parse_contact_trace("time_s,x,y,z\n", "t.csv"), InputError);
  EXPECT_THROW(parse_contact_trace("", "t.csv"), InputError);
}

}  // namespace
}  // namespace hapbench::recordings_test
