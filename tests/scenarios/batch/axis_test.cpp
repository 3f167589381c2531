#include "scenarios/batch/axis.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "scenarios/input/input_error.hpp"
#include "tests/results/files.hpp"

/// Tests the values of axes. The errors for wrong axes are in tests/data/golden/refused_sweeps.txt.
namespace hapbench::axis_test {
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
  // A constant range gives the same value everywhere: no rounding leaves the range.
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

TEST(Axis, OfAWrongRangeSuggestsTheRangeThatWasMeant) {
  const auto refusal = [](const std::string& values, bool sampled) -> std::string {
    try {
      parse_axis("a=" + values, sampled, "--over");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto suggests = [&](const std::string& values, const std::string& range, bool sampled = false) {
    EXPECT_NE(refusal(values, sampled).find("nearest valid form: \"" + range + "\"; allowed: a:b"), std::string::npos)
        << values << ": " << refusal(values, sampled);
  };
  for (const char* values : {"1e3:3e4:5log", "1e3:3e4:log5", "1e3:3e4:log:5"}) suggests(values, "1e3:3e4:5:log");
  suggests("1:2:5:", "1:2:5");
  suggests("1:2:log5", "1:2:log", true);
  suggests("1:2:5:log", "1:2:log", true);
  suggests("1:2:5", "1:2", true);
  for (const char* values : {"1:2", "1:2:log", "1:2:1", "1:2:2.5", "1:2:5:lin", "1:2:3:log:log", "1:2:7000000log"})
    EXPECT_EQ(refusal(values, false).find("nearest"), std::string::npos) << refusal(values, false);
  EXPECT_EQ(refusal("1:2", false).find("--over \"a=1:2\": got 2 parts between colons; allowed: a:b:n, or a:b:n:log"),
            0u)
      << refusal("1:2", false);
  EXPECT_EQ(
      refusal("1,5:2,5:3", false).find("--over \"a=1,5:2,5:3\": got a range with commas; allowed: decimal points"), 0u)
      << refusal("1,5:2,5:3", false);
  EXPECT_EQ(refusal("a:b,c", false), "accepted");
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

}  // namespace
}  // namespace hapbench::axis_test
