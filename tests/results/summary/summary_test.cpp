#include "results/summary/summary.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "results/io/columns.hpp"
#include "results/observe/contact_metrics.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/metrics.hpp"
#include "results/observe/target_metrics.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/provenance.hpp"

namespace hapbench::summary_test {
namespace {

TEST(Summary, WritesADivergenceThatIsNotFiniteAsNullAndText) {
  Result run;
  run.end.outcome = Outcome::diverges;
  run.end.divergence.magnitude = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(summary_json(run)["divergence"]["magnitude"].is_null());
  EXPECT_EQ(summary_json(run)["divergence"]["magnitude_text"], "inf");
  run.end.divergence.magnitude = -std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(summary_json(run)["divergence"]["magnitude"].is_null());
  EXPECT_EQ(summary_json(run)["divergence"]["magnitude_text"], "nan");
}

/// The suffix of a name that ends in its unit, as units are written in names.
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
  for (const ResultTable* table : {&kTrajectoryTable, &kContactTable, &kStiffnessTable, &kRatioTable, &kEnergyTable,
                                   &kIdealTrajectoryTable, &kForceReferenceTable, &kTargetTable})
    expect_documented(table->columns, table->file);
}

TEST(Metrics, AreDocumentedWithTheUnitTheyAreNamedAfter) {
  expect_documented(told(MetricsObserver(1.0)), "metrics");
  expect_documented(told(PassivityObserver()), "passivity");
  expect_documented(told(EnergyLedger()), "energy");
  expect_documented(told(IdealTrajectoryObserver()), "ideal trajectory");
  expect_documented(told(ForceFidelityObserver()), "fidelity");
  expect_documented(told(LostTorqueObserver()), "torque");
  expect_documented(told(TargetMetricsObserver()), "targets");
}

TEST(Provenance, NamesTheBuild) {
  const Provenance p = provenance();
  EXPECT_TRUE(std::regex_match(p.version, std::regex(R"(\d+\.\d+\.\d+)"))) << p.version;
  EXPECT_TRUE(std::regex_match(p.commit, std::regex("unknown|[-.0-9A-Za-z_/]+"))) << p.commit;
  EXPECT_TRUE(std::regex_match(p.compiler, std::regex(R"([A-Za-z]+ \d+(\.\d+)*)"))) << p.compiler;
  EXPECT_FALSE(p.cpu.empty());
  EXPECT_NE(p.flags.find("-ffp-contract=off"), std::string::npos) << p.flags << ": they can change numbers";
}

TEST(Provenance, CpuModelIsTheFirstOneOfCpuinfo) {
  std::istringstream cpuinfo("processor\t: 0\nmodel\t\t: 1\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: Other\n");
  EXPECT_EQ(cpu_model(cpuinfo), "Some CPU @ 2 GHz");
}

}  // namespace
}  // namespace hapbench::summary_test
