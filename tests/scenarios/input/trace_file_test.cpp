#include "scenarios/input/trace_file.hpp"

#include <gtest/gtest.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench::trace_file_test {
namespace {

const std::string kHeader = "time_s,x_m,y_m,z_m,ux,uy,uz,depth_m\n";

/// The message with which a trace of these rows is refused; empty when it is read.
std::string refusal(const std::string& rows) {
  try {
    trace_in(kHeader + rows, "t.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TraceFile, HasContactsByTime) {
  const ContactTrace trace =
      trace_in(kHeader + "0,1,2,3,0,0,-1,0.5\n0,4,5,6,1,0,0,0\n\n0.25,7,8,9,0,0.6,0.8,1e-3\n", "t.csv");
  ASSERT_EQ(trace.times.size(), 2u);
  EXPECT_EQ(trace.times[1].time, 0.25);
  EXPECT_EQ(trace.times[1].first, 2u);
  EXPECT_EQ(trace.most(), 2u);
  ASSERT_EQ(trace.contacts.size(), 3u);
  EXPECT_EQ(trace.contacts[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(trace.contacts[2].gradient, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(trace.contacts[2].depth, 1e-3);
  EXPECT_TRUE(trace_in(kHeader, "t.csv").times.empty());
}

TEST(TraceFile, NormalisesRoundedGradientsAlone) {
  const double exact = 0.57735026918962573;
  const auto gradient = [](const std::string& text) {
    return trace_in(kHeader + "0,0,0,0," + text + ",1\n", "t.csv").contacts[0].gradient;
  };
  EXPECT_EQ(gradient("0.57735026918962573,0.57735026918962573,0.57735026918962573"), Vec3::Constant(exact));
  EXPECT_NEAR(gradient("0.5774,0.5774,0.5774").norm(), 1.0, 1e-15);
}

TEST(TraceFile, IsRefusedWithItsRow) {
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,1\n0.1,0,0,0,0,0,1,1\n0.05,0,0,0,0,0,1,1\n"),
            "t.csv, contact 3: got time 0.05 after 0.1; allowed: ascending times");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1.01,1\n"),
            "t.csv, contact 1: got a gradient ux,uy,uz of length 1.01; allowed: 1 within 0.001");
  EXPECT_EQ(refusal("0,0,0,0,0,0,0,1\n"),
            "t.csv, contact 1: got a gradient ux,uy,uz of length 0; allowed: 1 within 0.001");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,-1e-9\n"),
            "t.csv, contact 1: got depth -1e-09; allowed: >= 0, how deep the point is in the tool");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,nan\n"), "t.csv, line 2: column 8: got \"nan\"; allowed: a finite number");
  EXPECT_EQ(refusal("0,0,0,1e999,0,0,1,1\n"), "t.csv, line 2: column 4: got \"1e999\"; allowed: a finite number");
  EXPECT_NE(refusal("0,0,0\n"), "");
  std::string many;
  for (int i = 0; i < 100'001; ++i) many += "0,0,0,0,0,0,1,1\n";
  EXPECT_EQ(refusal(many), "t.csv, contact 100001: got more contacts at time 0; allowed: at most 100000");
  EXPECT_THROW(trace_in("time_s,x,y,z\n", "t.csv"), InputError);
  EXPECT_THROW(trace_in("", "t.csv"), InputError);
}

}  // namespace
}  // namespace hapbench::trace_file_test
