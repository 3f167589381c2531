#include "results/summary/summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "results/io/columns.hpp"
#include "results/observe/contact_metrics.hpp"
#include "results/observe/energy_ledger.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/metrics.hpp"
#include "results/observe/passivity_observer.hpp"
#include "results/observe/target_metrics.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/outcome_names.hpp"
#include "results/summary/provenance.hpp"

namespace hapbench::summary_test {
namespace {

Result example() {
  Result run;
  run.name = "springs";
  run.algorithm = "shaped_stiffness";
  run.end.outcome = Outcome::leaves_hole;
  run.end.rows = 400;
  run.expected = true;
  run.warnings = {{"open_edge", "", "touched the mesh near an edge"}};
  run.duration = 0.2;
  run.metrics = {{"force_max_N", "N", "largest ||f|| of a row", 1.5},
                 {"steps_in_contact", "1", "rows with a colliding point", std::uint64_t{300}},
                 {"ratio_max", "1", "largest such ratio", std::optional<double>()}};
  run.metrics.emplace_back("force_step_p99_N", "N", "99 % of the rows", 0.5).within(0.25, 0.125);
  for (const auto& [name, value] : {std::pair{"final_position_m.x", 0.5},
                                    {"final_position_m.y", -0.25},
                                    {"final_position_m.z", 0.0},
                                    {"passivity.energy_min_J", -0.25},
                                    {"targets.0.success_rate.mean", 0.75},
                                    {"targets.1.success_rate.mean", 1.0}})
    run.metrics.emplace_back(name, "1", "x of f", value);
  run.sections = {{"passivity", {{"events", 2}}}, {"targets", nlohmann::ordered_json::object()}};
  run.state_hash = 0x0123456789abcdefu;
  run.tool = ToolSummary{.half_width = 0.5, .reach = 2.0, .convex = false, .outline = {{0.0, 0.25}}};
  run.work = {.search = {.queries = 401, .points_tested = 5000, .lists_rebuilt = 7},
              .steps_skipped = 8,
              .algorithm = {.iterations = 900, .points_dropped = 9, .steps_controlled = 3},
              .allocations = 0};
  run.provenance = {.version = "1.2.3",
                    .commit = "abc-dirty",
                    .compiler = "GNU 12.2.0",
                    .build_type = "Release",
                    .flags = "-O3 -ffp-contract=off",
                    .cpu = "Some CPU"};
  run.scenario_hash = "fedcba9876543210";
  return run;
}

TEST(Summary, TextHoldsEveryField) {
  EXPECT_EQ(summary_text(example()), R"({
  "name": "springs",
  "algorithm": "shaped_stiffness",
  "outcome": "leaves_hole",
  "expected": true,
  "steps": 400,
  "duration_s": 0.2,
  "divergence": null,
  "warnings": ["touched the mesh near an edge"],
  "metrics": {
    "force_max_N": 1.5,
    "steps_in_contact": 300,
    "ratio_max": null,
    "force_step_p99_N": 0.5,
    "final_position_m": [0.5, -0.25, 0]
  },
  "passivity": {
    "energy_min_J": -0.25,
    "events": 2
  },
  "tool": {
    "half_width_m": 0.5,
    "reach_m": 2,
    "convex": false,
    "outline_m": [
      [0, 0.25]
    ]
  },
  "targets": {
    "0": {
      "success_rate": {
        "mean": 0.75
      }
    },
    "1": {
      "success_rate": {
        "mean": 1
      }
    }
  },
  "tolerances": {
    "force_step_p99_N": 0.25
  },
  "state_hash": "0123456789abcdef",
  "work": {
    "queries": 401,
    "points_tested": 5000,
    "lists_rebuilt": 7,
    "steps_skipped": 8,
    "iterations": 900,
    "points_dropped": 9,
    "steps_controlled": 3,
    "allocations": 0
  },
  "provenance": {
    "hapbench_version": "1.2.3",
    "commit": "abc-dirty",
    "compiler": "GNU 12.2.0",
    "build_type": "Release",
    "flags": "-O3 -ffp-contract=off",
    "cpu": "Some CPU",
    "scenario_hash": "fedcba9876543210"
  }
}
)");
}

TEST(Summary, OfADivergedRunSaysWhereItLeftItsBound) {
  Result run = example();
  run.end.outcome = Outcome::diverges;
  run.end.divergence = {.step = 12, .time = 0.006, .quantity = "velocity", .magnitude = 2e6, .bound = 1e6};
  const auto json = summary_json(run);
  EXPECT_EQ(json["outcome"], "diverges");
  EXPECT_EQ(json["divergence"].dump(),
            R"({"step":12,"time_s":0.006,"quantity":"velocity","magnitude":2000000.0,"bound":1000000.0})");
}

TEST(Summary, WritesADivergenceThatIsNotFiniteAsNullAndText) {
  Result run = example();
  run.end.outcome = Outcome::diverges;
  run.end.divergence.magnitude = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(summary_json(run)["divergence"]["magnitude"].is_null());
  EXPECT_EQ(summary_json(run)["divergence"]["magnitude_text"], "inf");
  run.end.divergence.magnitude = -std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(summary_json(run)["divergence"]["magnitude"].is_null());
  EXPECT_EQ(summary_json(run)["divergence"]["magnitude_text"], "nan");
}

// The summaries of the scalar and the SIMD build must be identical, so they must not name the instruction set.
TEST(Summary, WithTheRealProvenanceDoesNotNameTheInstructionSet) {
  Result run = example();
  run.provenance = provenance();
  const std::string text = summary_text(run);
  for (const std::string word : {"march", "native", "avx", "sse", "simd", "SIMD"}) {
    EXPECT_EQ(text.find(word), std::string::npos) << word << " in\n" << text;
  }
}

TEST(OutcomeNames, LeadBackToTheirOutcomes) {
  std::vector<std::string_view> names;
  for (const OutcomeInfo& outcome : outcome_infos()) {
    names.push_back(outcome.name);
    const auto named = outcome_named(outcome.name);
    ASSERT_TRUE(named) << outcome.name;
    EXPECT_EQ(outcome_name(*named), outcome.name);
  }
  EXPECT_EQ(names, (std::vector<std::string_view>{"completes", "leaves_hole", "tool_horizontal", "not_dragged", "stuck",
                                                  "no_contact", "lost_contact", "went_through", "diverges"}));
  EXPECT_EQ(outcome_name(Outcome::diverges), "diverges");
}

TEST(ColumnsJson, HoldsTheColumnsOfEachFileAndTheMetrics) {
  constexpr Column kColumns[] = {{"t_s", "s", "time"}, {"name", "", "who"}};
  const ResultTable table = {"a.csv", "what a line is", kColumns};
  const MetricList metrics = {{"force_max_N", "N", "largest force", 2.0}};
  EXPECT_EQ(columns_json({&table, 1}, metrics).dump(),
            R"({"summary.json":[{"name":"force_max_N","unit":"N","meaning":"largest force"}],)"
            R"("a.csv":[{"name":"t_s","unit":"s","meaning":"time"},{"name":"name","unit":"","meaning":"who"}]})");
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
}

TEST(Provenance, NamesTheFlagsThatCanChangeNumbers) {
  EXPECT_NE(provenance().flags.find("-ffp-contract=off"), std::string::npos) << provenance().flags;
}

TEST(Provenance, CpuModelIsTheFirstOneOfCpuinfo) {
  std::istringstream cpuinfo("processor\t: 0\nmodel\t\t: 1\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: Other\n");
  EXPECT_EQ(cpu_model(cpuinfo), "Some CPU @ 2 GHz");
}

}  // namespace
}  // namespace hapbench::summary_test
