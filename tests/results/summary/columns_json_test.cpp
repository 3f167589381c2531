#include "results/summary/columns_json.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>

#include "results/record/contact_recorder.hpp"
#include "results/record/energy_recorder.hpp"
#include "results/record/ideal_trajectory_recorder.hpp"
#include "results/record/ratio_recorder.hpp"
#include "results/record/stiffness_recorder.hpp"
#include "results/record/target_table.hpp"
#include "results/record/trajectory_recorder.hpp"

namespace hapbench::columns_json_test {
namespace {

TEST(ColumnsJson, HoldsTheColumnsOfEachFileAndTheMetrics) {
  constexpr Column kColumns[] = {{"t_s", "s", "time"}, {"name", "", "who"}};
  const ResultTable table = {"a.csv", "what a line is", kColumns};
  const MetricList metrics = {{"force_max_N", "N", "largest force", 2.0}};
  EXPECT_EQ(columns_json({&table, 1}, metrics).dump(),
            R"({"summary.json":[{"name":"force_max_N","unit":"N","meaning":"largest force"}],)"
            R"("a.csv":[{"name":"t_s","unit":"s","meaning":"time"},{"name":"name","unit":"","meaning":"who"}]})");
}

/// What comes behind the last "_" of a name that ends in its unit, as units are written in names.
std::string unit_in_name(std::string unit) {
  if (unit == "1" || unit.empty()) return "";
  if (unit == "m2/s2") return "_m2_per_s2";
  const std::pair<std::string, std::string> spelled[] = {{"/", "_per_"}, {" ", "_"}, {"1_per_", "per_"}};
  for (const auto& [sign, word] : spelled) {
    if (const auto at = unit.find(sign); at != std::string::npos) unit.replace(at, sign.size(), word);
  }
  return "_" + unit;
}

/// Names end in their units, and every entry says something.
template <class Entries>
void expect_documented(const Entries& entries, const std::string& where) {
  std::set<std::string> names;
  for (const auto& entry : entries) {
    std::string name = entry.name;
    EXPECT_TRUE(names.insert(name).second) << where << ": " << name << " twice";
    EXPECT_GE(std::string(entry.meaning).size(), std::string("x of f").size()) << where << ": " << name;
    for (const char* part : {".x", ".y", ".z", ".mean", ".standard_error", ".subjects"}) {
      if (name.ends_with(part)) name.resize(name.size() - std::string(part).size());
    }
    const std::string unit = unit_in_name(entry.unit);
    EXPECT_TRUE(name.ends_with(unit)) << where << ": " << name << " in " << entry.unit;
  }
}

TEST(Columns, AreDocumentedWithTheUnitTheyAreNamedAfter) {
  expect_documented(TrajectoryRecorder::columns({true, true}), "trajectory.csv");
  expect_documented(ContactRecorder::kColumns, "contacts.csv");
  expect_documented(StiffnessRecorder::kColumns, "stiffness_tensor.csv");
  expect_documented(RatioRecorder::kColumns, "ratios.csv");
  expect_documented(EnergyRecorder::kColumns, "energy.csv");
  expect_documented(IdealTrajectoryRecorder::kColumns, "ideal_trajectory.csv");
  expect_documented(kTargetColumns, "targets.csv");
}

TEST(Metrics, AreDocumentedWithTheUnitTheyAreNamedAfter) {
  expect_documented(metric_list(Metrics{}), "metrics");
  expect_documented(final_position_list(Metrics{}), "final position");
  expect_documented(metric_list(std::optional<PassivityMetrics>()), "passivity");
  expect_documented(metric_list(EnergyMetrics{}), "energy");
  expect_documented(metric_list(IdealTrajectoryMetrics{}), "ideal trajectory");
  expect_documented(metric_list(LostTorqueMetrics{}), "torque");
  expect_documented(metric_list(std::vector<PlaceMetrics>(1)), "targets");
}

}  // namespace
}  // namespace hapbench::columns_json_test
