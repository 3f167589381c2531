#include "scenarios/run/clock_coverage.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace hapbench::clock_coverage_test {
namespace {

/// Returns the time fields of a run of 0.1 s.
TimeFields run_time() {
  TimeFields time;
  time.step = 0.0005;
  time.steps = 200;
  return time;
}

/// Returns `count` times [s], from `first` on at intervals of `interval`.
std::vector<double> times(double first, double interval, std::size_t count) {
  std::vector<double> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(first + interval * static_cast<double>(i));
  return all;
}

std::string stroke_warning(const std::vector<double>& at) {
  std::vector<RecordedMotion::Sample> samples;
  for (const double t : at) samples.push_back({t, Vec3::Zero()});
  const auto warning = stroke_clock_warning(Stroke{RecordedMotion(std::move(samples)), {}}, run_time());
  return warning ? warning->text : "";
}

std::string trace_warning(const std::vector<double>& at, std::int64_t every = 1) {
  ContactTrace trace;
  for (const double t : at) {
    trace.times.push_back({t, trace.contacts.size()});
    trace.contacts.push_back({Vec3::Zero(), Vec3(0, 0, -1), 1e-4});
  }
  const auto warning = trace_clock_warning(trace, run_time(), every);
  return warning ? warning->text : "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(StrokeClock, IsAcceptedIfItCoversTheRun) {
  for (const auto& at : {times(0, 0.002, 51), times(0, 0.01, 10), times(-1, 0.001, 2000), times(0, 0.0001, 1000),
                         times(0, 0.002, 100'000)})
    EXPECT_EQ(stroke_warning(at), "");
}

TEST(StrokeClock, IsNamedWithItsUnit) {
  for (const auto& [scale, says] : {std::pair(1e3, "milliseconds"), {1e6, "microseconds"}, {1e9, "nanoseconds"}}) {
    EXPECT_TRUE(contains(stroke_warning(times(0, 0.002 * scale, 51)), says))
        << stroke_warning(times(0, 0.002 * scale, 51));
    EXPECT_TRUE(contains(stroke_warning(times(scale, 0.002 * scale, 51)), says)) << "no overlap";
  }
  EXPECT_TRUE(contains(stroke_warning(times(0, 2e-6, 51)), "multiply the times by 10^3"));
  EXPECT_TRUE(contains(stroke_warning(times(0, 2e-9, 51)), "multiply the times by 10^6"));
}

TEST(StrokeClock, IsNamedIfItHasASingleSample) {
  EXPECT_TRUE(contains(stroke_warning({0.0}), "a single sample"));
}

TEST(StrokeClock, IsNamedIfItEndsEarly) {
  const std::string text = stroke_warning(times(0, 0.002, 26));
  EXPECT_TRUE(contains(text, "covers 50.5 % of the steps")) << text;
  EXPECT_TRUE(contains(text, "time.steps=101 ends the run with the stroke")) << text;
}

TEST(StrokeClock, IsNamedIfItStartsAfterTheRun) {
  const std::string text = stroke_warning(times(0.05, 0.002, 26));
  EXPECT_TRUE(contains(text, "covers 50 % of the steps; the tool stays at the first sample for 0.05 s")) << text;
  EXPECT_TRUE(contains(text, "subtract its first time")) << text;
  const std::string both = stroke_warning(times(0.025, 0.002, 26));
  EXPECT_TRUE(contains(both, "covers 50.5 % of the steps; the tool stays at the first sample for 0.025 s")) << both;
  EXPECT_TRUE(contains(both, "time.steps=151 ends the run with the stroke")) << both;
}

TEST(TraceClock, IsAcceptedIfStepsFindTheirTimes) {
  EXPECT_EQ(trace_warning(times(0, 0.0005, 200)), "");
  EXPECT_EQ(trace_warning(times(0.05, 0.0005, 100)), "") << "the tool comes from above";
  EXPECT_EQ(trace_warning(times(0, 0.004, 25), 8), "") << "a slower loop";
  EXPECT_EQ(trace_warning(times(0, 0.0005, 1000)), "") << "longer than the run";
}

/// Checks a log whose times all lie in the middle between two steps, with rounding errors.
TEST(TraceClock, IsAcceptedInTheMiddleOfTheSteps) {
  for (const double shift : {-1e-12, 0.0, 1e-12})
    EXPECT_EQ(trace_warning(times(0.00025 + shift, 0.0005, 200)), "") << shift;
}

TEST(TraceClock, IsNamedIfItsRateDiffersALittle) {
  for (const double interval : {0.00057, 0.00053}) {
    const std::string text = trace_warning(times(0, interval, 200));
    EXPECT_TRUE(contains(text, "its clock does not have the run's step")) << interval << ": " << text;
  }
  // A tool that loses contact for single steps has no times there.
  std::vector<double> gaps = times(0, 0.0005, 200);
  for (std::size_t i = 10; i < gaps.size(); i += 9) gaps.erase(gaps.begin() + static_cast<std::ptrdiff_t>(i));
  EXPECT_EQ(trace_warning(gaps), "");
}

TEST(TraceClock, IsNamedWithItsUnit) {
  for (const auto& [scale, says] : {std::pair(1e3, "milliseconds"), {1e6, "microseconds"}, {1e9, "nanoseconds"}}) {
    const std::string text = trace_warning(times(0, 0.0005 * scale, 200));
    EXPECT_TRUE(contains(text, says)) << text;
    EXPECT_TRUE(contains(text, "199 of the 200 steps")) << text;
  }
  EXPECT_TRUE(contains(trace_warning(times(0, 0.0005e-3, 200)), "multiply the times by 10^3"));
}

TEST(TraceClock, IsNamedIfTheTraceEndsEarlyOrHasAnotherRate) {
  EXPECT_TRUE(contains(trace_warning(times(0, 0.0005, 20)), "the trace ends before the run"));
  EXPECT_TRUE(contains(trace_warning(times(0, 0.004, 25)), "rendering.contacts.every=8"));
  EXPECT_TRUE(contains(trace_warning(times(0, 0.000125, 800)), "the trace is faster than the run"));
  EXPECT_TRUE(contains(trace_warning(times(1.7e9, 0.0005, 200)), "subtract the time at which the recording began"));
  EXPECT_FALSE(contains(trace_warning(times(1.7e9, 0.0005, 200)), "seconds")) << "its unit is right";
  EXPECT_TRUE(
      contains(trace_warning(times(1.7e18, 0.5e6, 200)), "from the times of the trace; its clock seems to be in nano"));
  EXPECT_TRUE(contains(trace_warning({}), "the trace has no rows"));
}

}  // namespace
}  // namespace hapbench::clock_coverage_test
