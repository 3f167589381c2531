#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "results/observe/contact_metrics.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/metrics.hpp"
#include "results/observe/target_metrics.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/allocations.hpp"
#include "results/summary/summary.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "tests/results/files.hpp"
#include "tests/results/observing.hpp"

namespace hapbench::recorder_test {
namespace {

using test::lines_of;
using test::read_file;
using test::TemporaryDirectory;

// Tests the tables of a run, except the numbers in their columns, which tests/known_answers tests.

/// Returns the lines of the table that a recorder writes for these steps, without the header.
std::vector<std::string> recorded(const RowSource& source, const std::vector<StepRecord>& rows,
                                  std::uint64_t every = 1) {
  const TemporaryDirectory dir;
  Recorder recorder(dir / "table.csv", source, every);
  for (const StepRecord& row : rows) recorder.on_step(row);
  recorder.finish();
  std::vector<std::string> lines = lines_of(read_file(dir / "table.csv"));
  lines.erase(lines.begin());
  return lines;
}

TEST(TrajectoryRecorder, WritesTheQuaternionWhoseFirstNumberIsNotNegative) {
  const ContactBuffer none(1);
  std::vector<StepRecord> rows;
  for (const double roll : {-3.5, -2.0, 2.0, 3.5, 5.0}) {
    rows.push_back(test::row(rows.size(), 0.0, none));
    rows.back().roll = roll;
  }
  for (const std::string& line : recorded(trajectory_rows({.pose = true}), rows))
    EXPECT_NE(line.find(",,,0."), std::string::npos) << line;
}

constexpr ShapingOperations kShaping = {.start =
                                            [](ContactBuffer& contacts) noexcept {
                                              for (std::size_t i = 0; i < contacts.size(); ++i)
                                                contacts.weight[i] = 1.0;
                                              return stiffness_tensor(contacts);
                                            },
                                        .update =
                                            [](ContactBuffer& contacts, const Mat3& S) noexcept {
                                              for (std::size_t i = 0; i < contacts.size(); ++i) {
                                                contacts.weight[i] /=
                                                    contacts.gradient(i).dot(S * contacts.gradient(i));
                                              }
                                              return stiffness_tensor(contacts);
                                            }};

TEST(RatioRecorder, StartsFromEqualWeightsAndLeavesThoseOfTheRunUnchanged) {
  ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitX()});
  contacts.weight[0] = contacts.weight[1] = 0.125;
  const AlignedDoubles weights = contacts.weight;
  const auto lines = recorded(ratio_rows({1, 0, 1}, kShaping, 2), {test::row(0, 0.0, contacts)});
  EXPECT_EQ(lines, (std::vector<std::string>{"0,0,0,2,2,2,2", "0,0,1,2,1,1,1"}));
  EXPECT_EQ(contacts.weight, weights);
}

TEST(TargetTable, HasEmptyCellsForATargetThatTheTipNeverWasOn) {
  const TemporaryDirectory dir;
  TargetRow missed;
  missed.result = {0, false, 10.0};
  write_target_table(dir / "targets.csv", {missed});
  EXPECT_EQ(lines_of(read_file(dir / "targets.csv")).at(1), "0,0,0,0,0,10,0,,");
}

TEST(Recorders, OfContactsWriteNothingForRowsWithoutContactAndRowsBetween) {
  const ContactBuffer none(1), one = test::contacts_along({Vec3::UnitX()});
  for (const RowSource& source : {contact_rows(), ratio_rows({0}, kShaping, 1)}) {
    const auto lines = recorded(source, {test::row(0, 0.0, none), test::row(1, 0.0, one), test::row(2, 0.0, one)}, 2);
    ASSERT_EQ(lines.size(), 1u) << header_of(source.columns);
    EXPECT_TRUE(lines[0].starts_with("2,")) << lines[0];
  }
}

TEST(Recorders, AllocateNothingInAStep) {
  const ContactBuffer contacts = test::contacts_along(std::vector<Vec3>(100, Vec3::UnitX()));
  StepRecord r = test::row(4, 0.002, contacts);
  r.tool.pose = {{0, 0, -0.001}, {-std::sin(0.5), 0, -std::cos(0.5)}};
  r.force.S = Mat3::Identity() / 3.0;
  r.force.spring = {13, 14, 15};
  EnergyLedger ledger(2.0, 0.5, true, contacts.size());
  IdealTrajectoryObserver ideal({}, {});
  const ReferenceForce reference(ReferenceForce::Ideal{});
  ForceFidelityObserver fidelity(reference, 0.5, 1);
  const TemporaryDirectory dir;
  for (const RowSource& source : {trajectory_rows({.pose = true, .torque = true}), contact_rows(), stiffness_rows(),
                                  ratio_rows({0, 1, 5}, kShaping, contacts.size()), energy_rows(ledger),
                                  ideal_trajectory_rows(ideal), force_reference_rows(fidelity)}) {
    Recorder recorder(dir / "table.csv", source);
    const AllocationCount count;
    for (int k = 0; k < 1000; ++k) {  // several times the size of the file's buffer
      r.springs.energy += k;          // an event of the ledger in every step
      ledger.on_step(r);
      ideal.on_step(r);
      fidelity.on_step(r);
      recorder.on_step(r);
    }
    EXPECT_EQ(count.value(), 0u) << header_of(source.columns);
    recorder.finish();
    EXPECT_GE(lines_of(read_file(dir / "table.csv")).size(), 1001u) << header_of(source.columns);
  }
}

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

/// Returns the suffix that a name with this unit must have, such as "_m2_per_s2" for "m2/s2".
std::string unit_in_name(std::string unit) {
  if (unit == "1" || unit.empty()) return "";
  if (unit == "m2/s2") return "_m2_per_s2";
  const std::pair<std::string, std::string> spelled[] = {{"/", "_per_"}, {" ", "_"}, {"1_per_", "per_"}};
  for (const auto& [sign, word] : spelled) {
    if (const auto at = unit.find(sign); at != std::string::npos) unit.replace(at, sign.size(), word);
  }
  return "_" + unit;
}

/// Checks that names end with their units, and that every entry has a meaning.
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
  expect_documented(reported(MetricsObserver(1.0)), "metrics");
  expect_documented(reported(PassivityObserver()), "passivity");
  expect_documented(reported(EnergyLedger()), "energy");
  expect_documented(reported(IdealTrajectoryObserver()), "ideal trajectory");
  expect_documented(reported(ForceFidelityObserver()), "fidelity");
  expect_documented(reported(LostTorqueObserver()), "torque");
  expect_documented(reported(TargetMetricsObserver()), "targets");
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
}  // namespace hapbench::recorder_test
