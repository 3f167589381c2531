#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/sweep_row.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/shared_shells.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Rows = std::map<std::size_t, std::string>;

/// "sweep", or "sweep_shard_0_of_4": sweeps of one directory do not get into each other's way.
std::string stem_of(const std::optional<Shard>& shard) {
  return shard ? fmt::format("sweep_shard_{}_of_{}", shard->index, shard->count) : "sweep";
}

std::string journal_title(const SweepPlan& plan, const SweepOptions& options) {
  return fmt::format("definition {}, shard {}, {}", plan.definition, shard_text(options.part()),
                     options.keep_runs ? "runs are kept" : "runs are not kept");
}

/// What the journal holds. Its first line is right, but somebody may have written to it.
Rows journal_rows(const SweepPlan& plan, const SweepOptions& options, const Journal& journal) {
  Rows rows;
  for (const std::string& row : journal.rows()) {
    const auto run = run_of_row(plan, row);
    if (!run || !options.part().has(*run)) {
      fail_in_file(journal.file(), fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
    }
    rows[*run] = row;
  }
  return rows;
}

/// The runs that are to be done, those of one environment after each other, so that few shells are needed at a time.
std::vector<std::size_t> runs_to_do(const SweepPlan& plan, const Shard& shard, const Rows& done) {
  std::vector<std::size_t> runs;
  for (std::size_t run = shard.index; run < plan.points.size(); run += shard.count) {
    if (!done.contains(run)) runs.push_back(run);
  }
  std::stable_sort(runs.begin(), runs.end(),
                   [&plan](std::size_t a, std::size_t b) { return plan.environments[a] < plan.environments[b]; });
  return runs;
}

std::vector<std::size_t> uses_of_environments(const SweepPlan& plan, const std::vector<std::size_t>& runs) {
  std::vector<std::size_t> uses(plan.environment_count);
  for (const std::size_t run : runs) ++uses[plan.environments[run]];
  return uses;
}

std::string computed_row(const SweepPlan& plan, const SweepOptions& options, SharedShells& shells, std::size_t run) {
  const LoadedScenario loaded = scenario_of(plan, run);
  const auto shell = shells.take(plan.environments[run], loaded.scenario);
  std::optional<fs::path> output;
  if (options.keep_runs) output = options.directory / "runs" / fmt::format("{:06}", run);
  return sweep_row(plan, run, run_with_shell(loaded, shell, output, false).summary);
}

/// Does the runs that have no row yet.
void compute_rows(const SweepPlan& plan, const SweepOptions& options, Journal& journal, Rows& rows,
                  SweepReport& report) {
  const std::vector<std::size_t> runs = runs_to_do(plan, options.part(), rows);
  SharedShells shells(uses_of_environments(plan, runs));
  ProgressBar bar("sweep", rows.size() + runs.size(), options.progress);
  bar.start_at(rows.size());
  const auto deliver = [&](std::size_t run, const std::string& row) {
    journal.add(row);
    rows[run] = row;
    bar.show(rows.size(), true);
  };
  const auto deliver_failure = [&](std::size_t run, const std::string& problem) {
    rows[run] = error_row(plan, run);
    if (!report.failed || run < report.failed->run) report.failed = FailedRun{run, problem};
  };
  const auto work = [&](std::size_t run) -> Delivery {
    try {
      return [&deliver, run, row = computed_row(plan, options, shells, run)] { deliver(run, row); };
    } catch (const Stopped&) {
      return {};  // --resume computes it
    } catch (const std::exception& error) {
      return [&deliver_failure, run, problem = std::string(error.what())] { deliver_failure(run, problem); };
    }
  };
  parallel_for(runs, options.jobs, work, [] { return StopSignal::received() != 0; });
  if (rows.size() < options.part().size(plan.points.size())) report.signal = StopSignal::received();
}

}  // namespace

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  const std::string stem = stem_of(options.shard);
  Journal journal(options.directory / (stem + ".journal"), journal_title(plan, options), options.resume);
  remove_stale_temporaries(options.directory);
  Rows rows = journal_rows(plan, options, journal);
  SweepReport report;
  report.resumed = rows.size();
  compute_rows(plan, options, journal, rows, report);
  for (auto& [run, row] : rows) report.rows.push_back(std::move(row));
  if (report.signal != 0) return report;
  report.table = options.directory / (stem + ".csv");
  write_file_atomically(options.directory / (stem + ".json"), json_text(sweep_description(plan, options.part())));
  write_sweep_table(report.table, plan, options.shard, report.rows);
  journal.remove();
  return report;
}

}  // namespace hapbench
