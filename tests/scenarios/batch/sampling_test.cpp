#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "tests/results/files.hpp"

/// Tests sampled points and files of --points. The errors for wrong samples are in
/// tests/data/golden/refused_sweeps.txt.
namespace hapbench::sampling_test {
namespace {

TEST(Sampling, HasItsPointsInTheUnitCubeAndMeansWhatItsSeedSays) {
  for (const std::string_view method : {kLatinHypercube, kRandomPoints}) {
    std::set<std::vector<double>> different;
    for (const std::uint64_t seed : {1u, 2u}) {
      for (std::size_t axis = 0; axis < 12; ++axis) {
        const std::vector<double> points = unit_sample({method, 100, seed}, axis);
        ASSERT_EQ(points.size(), 100u);
        std::set<std::size_t> strata;
        for (const double x : points) {
          EXPECT_TRUE(x >= 0.0 && x < 1.0);
          strata.insert(static_cast<std::size_t>(x * 100.0));
        }
        EXPECT_EQ(strata.size() == 100u, method == kLatinHypercube) << "one point in each stratum";
        EXPECT_EQ(unit_sample({method, 100, seed}, axis), points);
        different.insert(points);
      }
    }
    EXPECT_EQ(different.size(), 24u);
  }
}

/// Reads a file of --points with this content. Returns the axes as text, or the part of the error message that begins
/// with the file's name.
std::string points_of(const std::string& text) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "p.csv", text);
  std::vector<Axis> axes;
  try {
    read_points(directory / "p.csv", axes);
  } catch (const InputError& error) {
    return std::string(error.what()).substr(std::string(error.what()).find("p.csv"));
  }
  std::string shown;
  for (const Axis& axis : axes) shown += fmt::format("{}={} ", axis.path, fmt::join(axis.values, "|"));
  return shown;
}

TEST(PointsOfAFile, HaveAnySeparatorCommentsAndQuotes) {
  for (const char* text :
       {"a.b,c\n1,x\n2.5,y\n", "a.b;c\n1;x\n2.5;y\n", "a.b\tc\r\n1\tx\r\n\r\n2.5\ty\r\n", "a.b c\n 1  x\n2.5 y\n",
        "# a.b,c\n1,x\n2.5,y\n", "% made by x\n\"a.b\", \"c\"\n1,\"x\"\n# skipped\n2.5, y\n", "a.b,c,\n1,x,\n2.5,y,\n"})
    EXPECT_EQ(points_of(text), "a.b=1|2.5 c=x|y ") << text;
}

TEST(PointsOfAFile, AreRefusedOnceWithTheCause) {
  EXPECT_EQ(points_of("a.b;c\n0,5;1\n0,7;1\n"),
            "p.csv, line 2: a.b: got \"0,5\" with a decimal comma; allowed: a decimal point (1 more row has faults)");
  EXPECT_EQ(points_of("a.b,c\n1,2\nnan,2\n"), "p.csv, line 3: a.b: got \"nan\"; allowed: a finite number");
  EXPECT_EQ(points_of("a.b,c\n1,\n"), "p.csv, line 2: c: got an empty value");
  EXPECT_EQ(points_of("a.b,c,a.b\n1,2,3\n"),
            "p.csv, line 1: columns 1 and 3 are both named \"a.b\"; allowed: each field once");
  EXPECT_EQ(points_of(",a.b\n0,1\n"), "p.csv, line 1: column 1 has no name; allowed: the path of a field");
  EXPECT_EQ(points_of("index,a.b,c,outcome,force_max_N\n0,1,2,completes,\n"),
            "p.csv, line 1: is the result of a sweep; allowed: a table of fields and their values: of this file, the "
            "columns 2 to 3, before \"outcome\"");
  EXPECT_NE(points_of("a.b,c\n0,5,1,5\n").find("a decimal comma splits a number"), std::string::npos);
}

}  // namespace
}  // namespace hapbench::sampling_test
