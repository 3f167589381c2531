#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/point_shell_file.hpp"
#include "scenarios/input/read_ply.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::point_shell_file_test {
namespace {

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

TEST(ShellFile, AsCsvReadsBackBitForBit) {
  std::vector<SurfacePoint> points = surface_points(Hole2d{});
  const std::vector<SurfacePoint> more = random_points(1000);
  points.insert(points.end(), more.begin(), more.end());
  points.push_back({{-0.0, 5e-324, 1000.0}, {-0.0, 0.0, -1.0}});
  const auto again = parse_point_shell(format_point_shell(points, "s.csv"), "s.csv");
  ASSERT_EQ(again.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(bits(again[i].position[k]), bits(points[i].position[k])) << i;
      EXPECT_EQ(bits(again[i].normal[k]), bits(points[i].normal[k])) << i;
    }
  }
}

TEST(ShellFile, MayHaveAnExtensionInCapitals) {
  EXPECT_EQ(parse_point_shell("x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1\n", "POINTS.CSV").size(), 1u);
  EXPECT_EQ(shell_extension("a.Ply"), ".ply");
}

TEST(ShellFile, AsPlyReadsBackToSinglePrecision) {
  const std::vector<SurfacePoint> points = random_points(1000);
  const auto again = parse_point_shell(format_point_shell(points, "s.ply"), "s.ply");
  ASSERT_EQ(again.size(), points.size());
  // The tolerance is half a unit in the last of 24 bits, for positions up to 0.1 m and normals up to 1. It is larger
  // for normals, because normalisation also changes them.
  const double position_tolerance = 0.1 * 0x1p-24, normal_tolerance = 4 * 0x1p-24;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((again[i].position - points[i].position).cwiseAbs().maxCoeff(), position_tolerance) << i;
    EXPECT_LE((again[i].normal - points[i].normal).cwiseAbs().maxCoeff(), normal_tolerance) << i;
    EXPECT_NEAR(again[i].normal.norm(), 1.0, 1e-15);
  }
}

// ---- PLY

const std::string kSixFloats =
    "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n";

std::string header(const std::string& format, const std::string& count, const std::string& properties = kSixFloats,
                   const std::string& after = "") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + count + "\n" + properties + after + "end_header\n";
}

/// Returns the bytes of a number, with the most (`big_endian`) or least significant byte first.
template <class Bits>
std::string bytes(Bits value, bool big_endian) {
  std::string text;
  for (std::size_t i = 0; i < sizeof value; ++i) {
    const std::size_t shift = 8 * (big_endian ? sizeof value - 1 - i : i);
    text += static_cast<char>(static_cast<std::uint64_t>(value) >> shift & 0xff);
  }
  return text;
}
std::string float_bytes(float value, bool big_endian = false) {
  return bytes(std::bit_cast<std::uint32_t>(value), big_endian);
}

std::vector<SurfacePoint> read(const std::string& contents) {
  return parse_ply_points(contents, "points.ply");
}

TEST(ShellFile, IsReportedIfItRepeatsPoints) {
  std::vector<std::string> notes;
  // Another normal at the same position is no copy.
  const std::string csv = "x_m,y_m,z_m,nx,ny,nz\n1,0,0,0,0,1\n0,0,0,0,0,1\n0,0,0,0,1,0\n0,0,0,0,0,1\n-0,0,0,0,1,0\n";
  EXPECT_EQ(parse_point_shell(csv, "s.csv", &notes).size(), 5u);
  EXPECT_EQ(notes, std::vector<std::string>{
                       "points that repeat the position and the normal of an earlier point: 2, the first is point 3 in "
                       "line 5; each of them counts as a point of its own, also in the force"});
  notes.clear();
  parse_point_shell(header("ascii", "2") + "0 0 0 0 0 1\n0 0 0 0 0 1\n", "s.ply", &notes);
  EXPECT_EQ(notes.size(), 1u);
}

TEST(PlyPoints, MayHaveEveryScalarType) {
  const std::string properties =
      "property char x\nproperty uint8 y\nproperty int16 z\nproperty ushort nx\nproperty int ny\nproperty uint32 nz\n"
      "property double quality\nproperty float64 more\n";
  const std::string text = header("ascii", "1", properties) + "-1 200 -300 1 0 0 0.5 2\n";
  const std::string binary = header("binary_big_endian", "1", properties) + bytes(std::uint8_t{255}, true) +
                             bytes(std::uint8_t{200}, true) + bytes(std::uint16_t{65536 - 300}, true) +
                             bytes(std::uint16_t{1}, true) + bytes(std::uint32_t{0}, true) +
                             bytes(std::uint32_t{0}, true) + bytes(std::bit_cast<std::uint64_t>(0.5), true) +
                             bytes(std::bit_cast<std::uint64_t>(2.0), true);
  for (const std::string& contents : {text, binary}) {
    const auto points = read(contents);
    EXPECT_EQ(points[0].position, Vec3(-1, 200, -300));
    EXPECT_EQ(points[0].normal, Vec3(1, 0, 0));
  }
}

TEST(PlyPoints, AreRefusedIfANumberDoesNotFitItsType) {
  const std::string integers =
      "property uchar x\nproperty int y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n";
  for (const auto& [row, problem] :
       {std::pair("300 0 0 0 0 1\n",
                  "\"300\", but the header declares this property as uchar; allowed: an integer from 0 to 255"),
        {"0 0.01 0 0 0 1\n", "\"0.01\", but the header declares this property as int"}}) {
    const auto error = test::input_error_of([&, bytes = header("ascii", "1", integers) + row] { read(bytes); });
    ASSERT_TRUE(error) << row;
    EXPECT_NE(std::string(error->what()).find(problem), std::string::npos) << error->what();
  }
}

TEST(PlyPoints, AreReportedWithWhatTheReaderIgnores) {
  const auto notes_of = [](const std::string& text) {
    std::vector<std::string> notes;
    EXPECT_EQ(parse_point_shell(text, "points.ply", &notes).size(), 1u);
    return notes;
  };
  EXPECT_EQ(notes_of(header("ascii", "1") + "0 0 0 0 0 1\n1 1 1 0 0 1\n"),
            std::vector<std::string>{"lines after the last entry that the header declares, which were ignored: 1, the "
                                     "first is line 12"});
  EXPECT_EQ(
      notes_of(header("ascii", "1") + "0 0 0 0 0 1 7\n"),
      std::vector<std::string>{"lines with more values than the header declares, which were ignored: 1, the first "
                               "is line 11"});
  EXPECT_TRUE(notes_of(header("ascii", "1") + "0 0 0 0 0 1\n").empty());
}

TEST(ShellFile, IsRefusedOnceWithTheNumberOfPoints) {
  const auto error = test::input_error_of([] {
    parse_point_shell("x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1\n0,0,0,0,0,2\n2000,0,0,0,0,2\n0,0,0,0,0,3\n", "s.csv");
  });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(),
               "s.csv, line 3, point 1: got a normal of length 2; allowed: unit normals (2 more rows have faults)");
}

/// Checks errors of PLY files. tests/data/golden/refused_files.txt has further errors.
TEST(PlyPoints, AreRefusedWhereHeaderOrNumberIsWrong) {
  const std::string row = "0 0 0 0 0 1\n";
  std::string infinite;
  for (const float value : {0.0f, std::numeric_limits<float>::infinity(), 0.0f, 0.0f, 0.0f, 1.0f})
    infinite += float_bytes(value);
  for (const auto& [text, says] :
       {std::pair(std::string("ply\nformat ascii 2.0\nend_header\n"), ", line 2: unknown format"),
        {"ply\nelement vertex 1\n" + kSixFloats + "end_header\n" + row, "allowed: a header with"},
        {"ply\nformat ascii 1.0\nelement face 1\nend_header\n", "has no vertex"},
        {header("ascii", "1e3") + row, "allowed:"},
        {header("ascii", "1", "property float x\nproperty float y\nproperty float z\n") + "0 0 0\n",
         "got 0 vertex properties \"nx\"; allowed: one each of x, y, z, nx, ny, nz"},
        {header("ascii", "1", kSixFloats + "property float x\n"), "got 2 vertex properties \"x\""},
        {header("binary_little_endian", "1") + infinite,
         "point 0: got coordinate inf; allowed: finite, at most 1000 m"}}) {
    const auto error = test::input_error_of([&, bad = text] { parse_point_shell(bad, "points.ply"); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(std::string(error->what()).find(says), std::string::npos) << error->what();
  }
}

}  // namespace
}  // namespace hapbench::point_shell_file_test
