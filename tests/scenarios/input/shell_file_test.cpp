#include "scenarios/input/shell_file.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::shell_file_test {
namespace {

class ShellFile : public testing::Test {
 protected:
  static std::vector<SurfacePoint> read(const std::string& name, const std::string& contents) {
    return point_shell_in(contents, name);
  }
  std::string refusal_of(const std::string& name, const std::string& contents) const {
    SCOPED_TRACE(contents);
    const auto error = test::input_error_of([&] { read(name, contents); });
    if (!error) return "";
    const std::string message = error->what();
    EXPECT_EQ(message.find(name), 0u);
    return message.substr(name.size());
  }
  std::string csv_refusal_of(const std::string& rows) const {
    return refusal_of("s.csv", "x_m,y_m,z_m,nx,ny,nz\n" + rows);
  }
};

std::vector<SurfacePoint> random_points(std::size_t n) {
  Random random(5);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back({random.uniform(0.0, 0.1) * random.direction(), random.direction()});
  return points;
}

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

TEST_F(ShellFile, AsCsvReadsBackBitForBit) {
  std::vector<SurfacePoint> points = surface_points(Hole2d{});
  const std::vector<SurfacePoint> more = random_points(1000);
  points.insert(points.end(), more.begin(), more.end());
  points.push_back({{-0.0, 5e-324, 1000.0}, {-0.0, 0.0, -1.0}});
  const auto again = read("s.csv", point_shell_text(points, "s.csv"));
  ASSERT_EQ(again.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(bits(again[i].position[k]), bits(points[i].position[k])) << i;
      EXPECT_EQ(bits(again[i].normal[k]), bits(points[i].normal[k])) << i;
    }
  }
}

TEST_F(ShellFile, AsPlyReadsBackToSinglePrecision) {
  const std::vector<SurfacePoint> points = random_points(1000);
  const auto again = read("s.ply", point_shell_text(points, "s.ply"));
  ASSERT_EQ(again.size(), points.size());
  // Half a unit in the last of 24 bits, of numbers up to 0.1 and up to 1; normals also move by their normalisation.
  const double position_tolerance = 0.1 * 0x1p-24, normal_tolerance = 4 * 0x1p-24;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((again[i].position - points[i].position).cwiseAbs().maxCoeff(), position_tolerance) << i;
    EXPECT_LE((again[i].normal - points[i].normal).cwiseAbs().maxCoeff(), normal_tolerance) << i;
    EXPECT_NEAR(again[i].normal.norm(), 1.0, 1e-15);
  }
}

TEST_F(ShellFile, HasItsNormalsNormalised) {
  const auto points = read("s.csv", "x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1.0009\n0,0,0,0.6,0,0.8\n");
  EXPECT_EQ(points[0].normal, Vec3(0, 0, 1));
  EXPECT_EQ(points[1].normal, Vec3(0.6, 0, 0.8));
}

TEST_F(ShellFile, NeedsUnitNormals) {
  EXPECT_EQ(csv_refusal_of("0,0,0,0,0,1\n0,0,0,0,0,1.0011\n"),
            ": point 1: got a normal of length 1.0011; allowed: unit normals");
  for (const char* normal : {"0,0,0", "0,0,0.99", "1,1,1", "1e300,0,0"}) {
    EXPECT_NE(csv_refusal_of(std::string("0,0,0,") + normal + "\n").find("allowed: unit normals"), std::string::npos);
  }
}

TEST_F(ShellFile, NeedsCoordinatesWithinAKilometre) {
  EXPECT_NO_THROW(read("s.csv", "x_m,y_m,z_m,nx,ny,nz\n-1000,1000,0,0,0,1\n"));
  EXPECT_EQ(csv_refusal_of("0,-1000.1,0,0,0,1\n"), ": point 0: got coordinate 1000.1; allowed: finite, at most 1000 m");
  EXPECT_NE(csv_refusal_of("0,0,1e300,0,0,1\n"), "");
}

TEST_F(ShellFile, NeedsAPoint) {
  EXPECT_EQ(csv_refusal_of(""), ": has no points; allowed: at least one");
}

TEST_F(ShellFile, NeedsAKnownExtension) {
  for (const char* name : {"s.obj", "s", "s.CSV", ".csv"}) {
    EXPECT_EQ(refusal_of(name, "x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1\n"),
              ": has another extension; allowed: .csv or .ply");
    EXPECT_TRUE(test::input_error_of([&] { point_shell_text({}, name); }));
  }
}

}  // namespace
}  // namespace hapbench::shell_file_test
