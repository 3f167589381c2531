#include "scenarios/thesis/claims.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

/// The files that claims are judged by.
namespace hapbench::evidence_test {
namespace {

class ResultFile : public testing::Test {
 protected:
  Evidence evidence() {
    std::filesystem::create_directories(directory_ / "scene");
    return {{}, directory_.path(), [this](const std::string& name) { asked_for_ += name + " "; }};
  }
  std::map<std::string, std::vector<double>> table_of(const std::string& text) {
    const Evidence e = evidence();
    test::write_plainly(directory_ / "scene/trajectory.csv", text);
    return e.table("scene", "trajectory.csv");
  }

  test::TemporaryDirectory directory_;
  std::string asked_for_;
};

TEST_F(ResultFile, IsReadByColumn) {
  const auto table = table_of("time_s,outcome,force_N\n0,completes,1.5\n0.5,,\n");
  EXPECT_EQ(asked_for_, "scene ");
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table.at("time_s"), (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(table.at("force_N")[0], 1.5);
  EXPECT_TRUE(std::isnan(table.at("force_N")[1]));
  EXPECT_TRUE(std::isnan(table.at("outcome")[0]));
}

TEST_F(ResultFile, WithARowThatIsCutOffIsRefusedAndNotPassedOver) {
  const auto error = test::input_error_of([&] { table_of("a,b\n1,2\n3\n"); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("trajectory.csv, line 3: "), std::string::npos) << error->what();
  EXPECT_TRUE(test::input_error_of([&] { table_of(""); }));
}

TEST_F(ResultFile, GivesNumbersOfItsSummary) {
  const Evidence e = evidence();
  test::write_plainly(directory_ / "scene/summary.json", R"({"metrics": {"a": 2, "b": null}, "steps": 7})");
  EXPECT_EQ(e.number("scene", "metrics.a"), 2.0);
  EXPECT_TRUE(std::isnan(e.number("scene", "metrics.b")));
  EXPECT_EQ(e.number("scene", "steps"), 7.0);
  EXPECT_EQ(asked_for_, "scene scene scene ");
}

TEST(PublishedNumbers, FillTextsThatNameThem) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "some.json", R"({"values": [
    {"id": "A.raw", "mean": 37.8, "std": 17.7}, {"id": "B", "value": 0.00025, "at_most": 15}]})");
  const PublishedNumbers numbers(directory / "some.json");
  EXPECT_EQ(numbers.fill("raw <A.raw>, <B*1000 mm"), "raw 37.8 ± 17.7, <B*1000 mm");
  EXPECT_EQ(numbers.fill("<B.mean*1000> mm, <B.at_most>"), "0.25 mm, 15");
  EXPECT_EQ(numbers.fill("<A.raw.spread:.2f>"), "17.70");
  EXPECT_THROW(numbers.fill("<C>"), InputError);
}

}  // namespace
}  // namespace hapbench::evidence_test
