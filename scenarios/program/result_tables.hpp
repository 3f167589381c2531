#pragma once

#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/program/table.hpp"

/// The columns of the tables that commands write beside the files of single runs. Those who write them take their
/// headers from here.
namespace hapbench {

/// {x} and {y} are the names of the map's axes.
inline constexpr Column kStabilityMapColumns[] = {
    {"algorithm", "", "force algorithm"},
    {"{x}", "by name", "x of the map"},
    {"{y}", "by name", "y of the map"},
    {"class", "", "what became of the motion (describe stability)"},
    {"lambda_max", "1", "largest eigenvalue of S in the first row"},
    {"stability_margin", "1",
     "4 - 2 lambda B dt / M - lambda K dt^2 / M under leapfrog: below 0 unstable; empty without theory"},
    {"integrator", "", "integrator"},
    {"class_from_far", "",
     "what became of the motion from a thousand times as far; empty where a map has no such runs"},
    {"overrides", "", "of time step, device and hand, as --set gave them; empty without"}};

/// With one for each limit of the stiffness that is known (stiffness_limits.hpp).
std::span<const Column> stability_boundary_columns();

/// A column of the tables of `limit` and `compare --devices`, and its name before, which programs may still read.
inline constexpr Column kInconsistentColumn = {
    "inconsistent_runs", "1", "runs that are unstable on the stable side of the limit, or stable beyond it"};
inline constexpr Column kAstrayColumn = {"astray", "1", "the same as inconsistent_runs, by its former name"};

// The columns of tables that are defined as fields in the sources of their commands.
std::vector<Column> converge_columns();
std::vector<Column> converge_level_columns();
std::vector<Column> limit_columns();
std::span<const Column> limit_run_columns();
std::vector<Column> device_limit_columns();
std::vector<Column> device_run_columns();
std::vector<Column> stability_limit_columns();
std::vector<Column> root_locus_columns();
std::vector<Column> stress_columns();
std::vector<Column> tune_columns();
std::vector<Column> tune_trial_columns();

// The headings of printed tables, from which the tables are made; without those that are names of fields, metrics,
// scenes or algorithms.
std::vector<Table::Column> claim_headings();
std::vector<Table::Column> converge_headings();
std::vector<Table::Column> device_headings();
std::vector<Table::Column> diff_headings();
std::vector<Table::Column> league_headings();
std::vector<Table::Column> limit_headings(bool smallest);
std::vector<Table::Column> map_headings();
std::vector<Table::Column> run_headings();
std::vector<Table::Column> latency_headings();
std::vector<Table::Column> stability_headings();
std::vector<Table::Column> sweep_headings();
std::vector<Table::Column> tune_headings();

std::vector<Table::Column> joined_headings(const std::vector<std::vector<Table::Column>>& tables);
/// All of them, also those whose titles are names that `describe` knows.
std::vector<Table::Column> printed_headings();

/// The header of a stability map's table.
std::string map_header(std::span<const Column> columns, const std::string& x, const std::string& y);

/// A table that `describe` knows.
struct DescribedTable {
  std::string file, holds;
  std::vector<Column> columns;
};

/// Every table among the results of this program.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
