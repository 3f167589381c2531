#include "scenarios/batch/cases.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// What is refused of axes, samples and shards is in tests/data/golden/refused_sweeps.txt.
namespace hapbench::cases_test {
namespace {

using Values = std::vector<std::string>;

Values values_of(const std::string& text) {
  const Axis axis = parse_axis(text);
  Values values;
  for (std::size_t i = 0; i < axis.size(); ++i) values.push_back(axis.value(i));
  return values;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& value : values_of(text)) numbers.push_back(test::number_in(value));
  return numbers;
}

TEST(Axis, OfALinearRangeHasBothEndsAndDecimalsAsOneWritesThem) {
  EXPECT_EQ(parse_axis("a.b=0:1:11").path, "a.b");
  EXPECT_EQ(values_of("a=0:1:11"), (Values{"0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"}));
  EXPECT_EQ(values_of("a=10:-10:3"), (Values{"10", "0", "-10"}));
  EXPECT_EQ(values_of("a=100:1000:4"), (Values{"100", "400", "700", "1000"}));
}

TEST(Axis, OfALogarithmicRangeHasBothEndsAndDecades) {
  EXPECT_EQ(values_of("a=0.001:1000:7:log"), (Values{"0.001", "0.01", "0.1", "1", "10", "100", "1000"}));
  EXPECT_EQ(values_of("a=1000:10:3:log"), (Values{"1000", "100", "10"}));
}

TEST(Axis, EndPointsAreExactAndValuesBetweenThemInOrder) {
  for (const char* range :
       {"0.1:0.7:97", "0.1:0.7:97:log", "1e-300:1e300:97:log", "-1e300:1e300:97", "3:3.0000001:97"}) {
    const std::vector<double> values = numbers(std::string("a=") + range);
    ASSERT_EQ(values.size(), 97u);
    EXPECT_EQ(values.front(), std::strtod(range, nullptr)) << range;
    for (std::size_t i = 1; i < values.size(); ++i) EXPECT_LT(values[i - 1], values[i]) << range << " " << i;
  }
  EXPECT_EQ(numbers("a=0.1:0.7:97").back(), 0.7);
  EXPECT_EQ(numbers("a=0.1:0.7:97:log").back(), 0.7);
  // The same value throughout stays the same: no rounding leaves the range.
  for (const double value : numbers("a=0.1:0.1:1000")) ASSERT_EQ(value, 0.1);
}

TEST(Axis, OfAListHasItsValuesInOrderAndNumbersInOneSpelling) {
  EXPECT_EQ(values_of("rendering.algorithm=mean,summation"), (Values{"mean", "summation"}));
  EXPECT_EQ(values_of("a=4e4,1.50,-0,true,null,7"), (Values{"40000", "1.5", "-0", "true", "null", "7"}));
  EXPECT_EQ(values_of("a=5"), Values{"5"});
  EXPECT_EQ(values_of(R"(device={"type": "impedance", "preset": "omega.3"},[1, 2e0],"a,b")"),
            (Values{R"({"type":"impedance","preset":"omega.3"})", "[1,2.0]", R"("a,b")"}));
}

TEST(Axis, OfAFieldOfIntegersHasIntegers) {
  EXPECT_EQ(values_of("time.steps=1:10:4"), (Values{"1", "4", "7", "10"}));
  EXPECT_EQ(values_of("time.steps=1:1000:4:log"), (Values{"1", "10", "100", "1000"}));
  EXPECT_EQ(values_of("seed=1:2:3"), (Values{"1", "2", "2"}));
  EXPECT_EQ(values_of("time.step_s=0.25:0.75:3"), (Values{"0.25", "0.5", "0.75"}));
  EXPECT_EQ(parse_axis("seed=0:3", true).value_at(0.5), "2");
}

TEST(Axis, OfAllNamesOfAField) {
  EXPECT_EQ(values_of("integrator.type=all"),
            (Values{"leapfrog", "velocity_verlet", "rk4", "implicit_euler", "implicit_midpoint", "event"}));
  EXPECT_EQ(parse_axis("rendering.algorithm=all").values.front(), "original_averaging");
  EXPECT_EQ(values_of("name=all"), Values{"all"});
}

// ---- Samples

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

TEST(SampledAxis, IsARangeOrAList) {
  const Axis linear = parse_axis("a.b=1:3", true), logarithmic = parse_axis("a=1:1e4:log", true);
  EXPECT_EQ(linear.value_at(0.0), "1");
  EXPECT_EQ(linear.value_at(0.25), "1.5");
  EXPECT_EQ(parse_axis("a=3:1", true).value_at(0.25), "2.5");
  EXPECT_EQ(logarithmic.value_at(0.5), "100");
  const Axis list = parse_axis("a=x,y,z", true);
  EXPECT_EQ(list.value_at(0.0) + list.value_at(0.33) + list.value_at(0.34) + list.value_at(0.999), "xxyz");
}

// ---- Cases and shards

Cases cases_of(const Values& vary, std::optional<Sampling> sampling = {}) {
  std::vector<Axis> axes;
  for (const std::string& text : vary) axes.push_back(parse_axis(text, sampling.has_value()));
  return {{}, {}, std::move(axes), sampling};
}

TEST(Cases, OfAGridHaveAllCombinationsTheLastAxisFastest) {
  const Cases grid = cases_of({"a=1,2", "b=x", "c=p,q,r"});
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid.values(0), (Values{"1", "x", "p"}));
  EXPECT_EQ(grid.values(3), (Values{"2", "x", "p"}));
  EXPECT_EQ(grid.values(5), (Values{"2", "x", "r"}));
  EXPECT_EQ(grid.changes(4), (Values{"a=2", "b=x", "c=q"}));
}

TEST(Cases, AreThePointsOfAFile) {
  const test::TemporaryDirectory directory;
  const auto read = [&](const std::string& text) {
    test::write_plainly(directory / "points.csv", text);
    std::vector<Axis> axes;
    Sampling sampling = read_points(directory / "points.csv", axes);
    return Cases({}, {}, std::move(axes), std::move(sampling));
  };
  const Cases cases = read("environment.spacing_m,device\r\n2e-3,\"{\"\"type\"\": \"\"ideal\"\"}\"\n1e-3,x\n2e-3,x\n");
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_EQ(cases.changes(0), (Values{"environment.spacing_m=0.002", R"(device={"type":"ideal"})"}));
  EXPECT_EQ(cases.values(2), (Values{"0.002", "x"}));
  EXPECT_EQ(cases.at(1), 2u) << "neighbours share an environment";
  for (const auto& [text, says] :
       {std::pair{"a,b\n1\n", "points.csv, line 2: got 1 values"},
        std::pair{"a\n1\n,\n", "points.csv, line 3: got 2 values"},
        std::pair{"a\n1\n\n", "points.csv, line 3: got an empty value"}, std::pair{"a\n", "points.csv: has no rows"},
        std::pair{"", "has no rows"}, std::pair{"a,a\n1,2\n", "got \"a\" twice"}}) {
    const auto error = test::input_error_of([&, bad = text] { read(bad); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(std::string(error->what()).find(says), std::string::npos) << error->what();
  }
}

TEST(Cases, RefuseMoreRunsThanTheyMayHaveHoweverMany) {
  EXPECT_EQ(cases_of({"a=0:1:1000", "b=0:1:1000"}).size(), kMostRuns);
  // 1000^7 is beyond 64 bits.
  Values vary;
  for (const char path : std::string("abcdefg")) vary.push_back(std::string(1, path) + "=0:1:1000");
  EXPECT_TRUE(test::input_error_of([&] { cases_of(vary); }));
}

using Numbers = std::vector<std::size_t>;

/// The cases in the order of their runs.
Numbers order_of(const Cases& cases) {
  Numbers order;
  for (std::size_t place = 0; place < cases.size(); ++place) order.push_back(cases.at(place));
  return order;
}

TEST(Cases, OfOneEnvironmentFollowEachOther) {
  EXPECT_EQ(order_of(cases_of({"a=1,2", "b=1,2"})), (Numbers{0, 1, 2, 3}));
  EXPECT_EQ(order_of(cases_of({"a=1,2", "environment.spacing_m=1e-3,2e-3,3e-3", "environment.width_m=1,2"})),
            (Numbers{0, 6, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11}));
  EXPECT_EQ(order_of(cases_of({"environment.width_m=1,2", "scenario=x,y"})), (Numbers{0, 2, 1, 3}));
}

TEST(Cases, OfASampleFollowEachOtherByTheListedFields) {
  const Cases cases =
      cases_of({"environment.file=x.stl,y.stl", "environment.scale=1:2", "a=1:2"}, Sampling{kLatinHypercube, 40, 1});
  const Numbers order = order_of(cases);
  EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), 40u);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(cases.values(order[i])[0], i < 20 ? "x.stl" : "y.stl");
}

}  // namespace
}  // namespace hapbench::cases_test
