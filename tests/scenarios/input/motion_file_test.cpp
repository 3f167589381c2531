#include "scenarios/input/motion_file.hpp"

#include <gtest/gtest.h>

#include "tests/scenarios/support/errors.hpp"

namespace hapbench::motion_file_test {
namespace {

const std::string kHeader = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n";

const std::string kQuaternions = "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n";

constexpr const char* kFile = "stroke.csv";

class MotionFile : public testing::Test {
 protected:
  static RecordedMotion read(const std::string& rows) { return stroke_in(kHeader + rows, kFile).motion; }
  std::string refusal_of(const std::string& rows) const {
    SCOPED_TRACE(rows);
    const auto error = test::input_error_of([&] { read(rows); });
    return error ? std::string(error->what()).substr(std::string_view(kFile).size()) : "";
  }
};

TEST_F(MotionFile, IsPlayedBackLinearly) {
  const RecordedMotion motion = read("0,0,0,0,0,0,-1\n2,1,2,4,0,0,-1\n");
  EXPECT_FALSE(motion.position_is_free());
  EXPECT_EQ(motion.position_at(0.5), Vec3(0.25, 0.5, 1.0));
  EXPECT_EQ(motion.position_at(-1.0), Vec3(0, 0, 0));
  EXPECT_EQ(motion.position_at(3.0), Vec3(1, 2, 4));
}

TEST_F(MotionFile, HasItsAxesNormalised) {
  for (const char* axis : {"0,0,-1", "0,0,-1e-9", "0,0,-7", "0,0,-1e11"}) {
    EXPECT_EQ(read(std::string("0,0,0,0,") + axis + "\n").axis_at(0.0), Vec3(0, 0, -1)) << axis;
  }
}

TEST_F(MotionFile, NeedsASample) {
  EXPECT_EQ(refusal_of(""), ", sample 1: no samples; allowed: at least one");
}

TEST_F(MotionFile, NeedsIncreasingTimes) {
  EXPECT_EQ(refusal_of("0,0,0,0,0,0,-1\n0,0,0,0,0,0,-1\n"),
            ", sample 2: got time 0 after 0; allowed: strictly increasing times");
  EXPECT_EQ(refusal_of("0,0,0,0,0,0,-1\n1,0,0,0,0,0,-1\n0.5,0,0,0,0,0,-1\n"),
            ", sample 3: got time 0.5 after 1; allowed: strictly increasing times");
}

TEST_F(MotionFile, NeedsAxesThatAreDirections) {
  for (const char* axis : {"0,0,0", "1e-13,0,0", "0,1e300,0", "1e200,1e200,1e200"}) {
    EXPECT_EQ(
        refusal_of(std::string("0,0,0,0,0,0,1\n1,0,0,0,") + axis + "\n").find(", sample 2: got an axis of length"), 0u);
  }
}

/// A quarter of a turn about x takes the axis from -z to y.
TEST(MotionFileOfQuaternions, TurnsTheToolsFrameIntoTheWorlds) {
  const RecordedMotion motion = stroke_in(kQuaternions + "0,1,2,3,1,0,0,0\n1,1,2,3,0.7072,0.7072,0,0\n", kFile).motion;
  EXPECT_EQ(motion.axis_at(0.0), Vec3(0, 0, -1));
  EXPECT_LE((motion.axis_at(1.0) - Vec3(0, 1, 0)).norm(), 4e-16) << "normalised";
  EXPECT_EQ(motion.position_at(0.5), Vec3(1, 2, 3));
  EXPECT_TRUE(motion.scripts_roll());
}

TEST(MotionFileOfQuaternions, MustBeOfNormOneWithinAThousandth) {
  const auto refusal = [](const std::string& row) {
    const auto error = test::input_error_of([&] { stroke_in(kQuaternions + "0,0,0,0,1,0,0,0\n" + row, kFile); });
    return error ? std::string(error->what()) : "";
  };
  EXPECT_NO_THROW(stroke_in(kQuaternions + "1,0,0,0,0,1.0009,0,0\n", kFile));
  EXPECT_EQ(refusal("1,0,0,0,0,1.125,0,0\n"),
            "stroke.csv, sample 2: got a quaternion qw,qx,qy,qz of norm 1.125; allowed: 1 within 0.001");
  EXPECT_EQ(refusal("1,0,0,0,0,0,0,0\n").find("stroke.csv, sample 2: got a quaternion qw,qx,qy,qz of norm 0"), 0u);
}

TEST(MotionFileOfQuaternions, TheHeaderSaysWhatMayComeAfterThePosition) {
  const auto error = test::input_error_of([] { stroke_in("time_s,px_m,py_m,pz_m,qx,qy,qz,qw\n", kFile); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what())
                .find("allowed: \"time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\" or "
                      "\"time_s,px_m,py_m,pz_m,qw,qx,qy,qz\""),
            std::string::npos);
}

}  // namespace
}  // namespace hapbench::motion_file_test
