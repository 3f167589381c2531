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
#include "results/observe/target_metrics.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/outcome_names.hpp"
#include "results/summary/provenance.hpp"

namespace hapbench::summary_test {
namespace {

RunSummary example() {
  RunSummary run;
  run.name = "springs";
  run.algorithm = "shaped_stiffness";
  run.result.outcome = Outcome::leaves_hole;
  run.result.rows = 400;
  run.expected = true;
  run.warnings = {"touched the mesh near an edge"};
  run.duration = 0.2;
  run.metrics = {
      .rows = 400,
      .force_max = 1.5,
      .force_step_max = 0.75,
      .velocity_total_variation = 0.1,
      .force_reversals = 2,
      .vibration_power = 1e-7,
      .depth_max = 0.001,
      .ratio = RatioRange{0.75, 1.25},
      .colliding_mean = 20.5,
      .colliding_max = 40,
      .rendered_mean = 3.25,
      .rendered_max = 6,
      .steps_in_contact = 300,
      .last_contact = 0.1875,
      .speed_max = 0.5,
      .final_position = {0.5, -0.25, 0.0},
      .explicit_friction = ExplicitFriction{.limit = 79.5, .rows_beyond = 4, .first_step = 17},
      .reduction = ReductionJumps{.changes = 7, .step_max_squared = 0.0625, .step_max_squared_elsewhere = 0.01},
      .state_hash = 0x0123456789abcdefu};
  ContactForces& contact = run.metrics.contact;
  contact.landings = 2;
  contact.landing_rows = 10;
  contact.landing_max_squared = 4.0;
  contact.landing_step_max_squared = 9.0;
  contact.settled_rows = 4;
  contact.settled = 0.5;
  contact.sum = 6.0;
  contact.max_squared = 6.25;
  contact.step_max_squared = 0.25;
  for (int i = 0; i < 4; ++i) contact.steps.add_square(0.25);
  contact.above_cutoff_squares = 1.0;
  contact.reversals = 3;
  run.passivity = PassivityMetrics{.energy_min = -0.25, .time_of_min = 0.125, .energy_end = 0.5};
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
    "force_step_max_N": 0.75,
    "velocity_total_variation_m_per_s": 0.1,
    "force_reversals": 2,
    "vibration_power_above_30Hz_m2_per_s2": 1e-07,
    "depth_max_m": 0.001,
    "ratio_min": 0.75,
    "ratio_max": 1.25,
    "colliding_mean": 20.5,
    "colliding_max": 40,
    "rendered_mean": 3.25,
    "rendered_max": 6,
    "steps_in_contact": 300,
    "contact_share": 0.75,
    "last_contact_s": 0.1875,
    "speed_max_m_per_s": 0.5,
    "explicit_friction_limit_N": 79.5,
    "explicit_friction_rows_beyond": 4,
    "explicit_friction_first_step": 17,
    "landings": 2,
    "landing_force_max_N": 2,
    "landing_force_step_max_N": 3,
    "settled_s": 0.5,
    "force_mean_in_contact_N": 1.5,
    "settled_force_max_N": 2.5,
    "force_step_p99_N": 0.5,
    "settled_force_step_max_N": 0.5,
    "force_rms_above_30Hz_N": 0.5,
    "force_reversals_per_s": 6,
    "reduction_changes": 7,
    "reduction_force_step_max_N": 0.25,
    "inside_max_m": null,
    "inside_settled_m": null,
    "centre_inside_share": null,
    "vibration_last_quarter_m_per_s": null,
    "final_position_m": [0.5, -0.25, 0]
  },
  "passivity": {
    "energy_min_J": -0.25,
    "time_of_min_s": 0.125,
    "energy_end_J": 0.5,
    "net_created_J": 0.25
  },
  "tolerances": {
    "force_step_p99_N": 0.0039000009313225744
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
  RunSummary run = example();
  run.result.outcome = Outcome::diverges;
  run.result.divergence = {.step = 12, .time = 0.006, .quantity = "velocity", .magnitude = 2e6, .bound = 1e6};
  const auto json = summary_json(run);
  EXPECT_EQ(json["outcome"], "diverges");
  EXPECT_EQ(json["divergence"].dump(),
            R"({"step":12,"time_s":0.006,"quantity":"velocity","magnitude":2000000.0,"bound":1000000.0})");
}

TEST(Summary, WritesADivergenceThatIsNotFiniteAsNullAndText) {
  RunSummary run = example();
  run.result.outcome = Outcome::diverges;
  run.result.divergence.magnitude = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(summary_json(run)["divergence"]["magnitude"].is_null());
  EXPECT_EQ(summary_json(run)["divergence"]["magnitude_text"], "inf");
  run.result.divergence.magnitude = -std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(summary_json(run)["divergence"]["magnitude"].is_null());
  EXPECT_EQ(summary_json(run)["divergence"]["magnitude_text"], "nan");
}

TEST(Summary, HasNullForWhatDoesNotExist) {
  RunSummary run = example();
  run.metrics.ratio.reset();
  run.metrics.vibration_power.reset();
  const auto metrics = summary_json(run)["metrics"];
  EXPECT_TRUE(metrics["ratio_min"].is_null());
  EXPECT_TRUE(metrics["ratio_max"].is_null());
  EXPECT_TRUE(metrics["vibration_power_above_30Hz_m2_per_s2"].is_null());
}

// The summaries of the scalar and the SIMD build must be identical, so they must not name the instruction set.
TEST(Summary, WithTheRealProvenanceDoesNotNameTheInstructionSet) {
  RunSummary run = example();
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
  expect_documented(metric_list(Metrics{}), "metrics");
  expect_documented(final_position_list(Metrics{}), "final position");
  expect_documented(metric_list(std::optional<PassivityMetrics>()), "passivity");
  expect_documented(metric_list(EnergyMetrics{}), "energy");
  expect_documented(metric_list(IdealTrajectoryMetrics{}), "ideal trajectory");
  expect_documented(metric_list(ForceFidelity{}), "fidelity");
  expect_documented(metric_list(LostTorqueMetrics{}), "torque");
  expect_documented(metric_list(std::vector<PlaceMetrics>(1)), "targets");
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
