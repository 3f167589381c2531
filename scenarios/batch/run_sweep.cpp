#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/batch/sweep_columns.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path run_folder(const SweepOptions& options, std::size_t run) {
  return options.directory / "runs" / fmt::format("{:06}", run);
}

/// Returns true if a row of an earlier sweep can be kept. `columns`: number of cells in a row. Throws
/// InputError for a row of another table.
bool keeps_row(const SweepPlan& plan, const SweepOptions& options, std::size_t columns, std::size_t run,
               std::string_view row) {
  const std::vector<std::string> cells = csv_cells(row);
  if (cells.size() != columns)
    throw InputError(fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
  const bool has_failed = cells[1 + plan.cases.axes().size()] == kErrorOutcome;
  return !has_failed && (!options.keep_runs || fs::exists(run_folder(options, run) / "summary.json"));
}

/// Returns the runs of a shard that have no row yet, in execution order.
std::vector<std::size_t> remaining_runs(const SweepPlan& plan, const Shard& shard, const TableFile& table) {
  std::vector<std::size_t> remaining;
  for (std::size_t position = shard.index; position < plan.cases.size(); position += shard.count) {
    const std::size_t run = plan.cases.at(position);
    if (!table.rows()[run]) remaining.push_back(run);
  }
  return remaining;
}

/// Result of a run: its row; or, if the run ended with an exception, an empty row and the message of the exception.
struct RunRow {
  std::string row, problem;
};

/// Executes a run and returns its row.
RunRow row_of_run(const SweepPlan& plan, const SweepOptions& options, std::size_t run) {
  RunRow result;
  try {
    const auto output = options.keep_runs ? std::optional(run_folder(options, run)) : std::nullopt;
    const CheckedScenario scene = checked(plan.cases.load(run));
    result.row =
        finished_row(plan, run, run_scenario(scene, output, false, nullptr, Diagnose::nothing, {}, plan.length));
  } catch (const IoError&) {
    throw;  // results of further runs could not be written either; the user can continue the sweep with --resume
  } catch (const std::exception& error) {
    result.problem = error.what();
  }
  return result;
}

}  // namespace

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  // Open the table. With --resume, keep the rows of the earlier sweep.
  const Shard part = options.shard.value_or(Shard{});
  Json about = {{"definition", plan.definition}, {"runs", plan.cases.size()}, {"shard", shard_text(part)}};
  about.update(plan.content);
  const std::vector<std::string> columns = sweep_columns(plan);
  const TableFile::Keep keep = [&](std::size_t run, std::string_view row) {
    return keeps_row(plan, options, columns.size(), run, row);
  };
  TableFile table({options.table(), fmt::format("{}", fmt::join(columns, ",")), about, plan.cases.size()},
                  options.resume ? keep : nullptr);
  SweepReport report;
  report.resumed = table.count();
  // Execute the remaining runs.
  const std::vector<std::size_t> remaining = remaining_runs(plan, part, table);
  std::mutex mutex;  // protects `table` and `report`
  for_each_job(remaining.size(), options.jobs, [&](std::size_t k) {
    const std::size_t run = remaining[k];
    const RunRow result = row_of_run(plan, options, run);
    const bool failed = result.row.empty();
    const std::lock_guard lock(mutex);
    table.add(run, failed ? error_row(plan, run) : result.row);
    if (failed && (!report.failed || run < *report.failed)) {
      report.failed = run;
      report.problem = result.problem;
    }
    if (!failed && options.added) options.added();
  });
  table.finish();
  return report;
}

}  // namespace hapbench
