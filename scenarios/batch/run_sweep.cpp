#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <exception>

#include "results/io/atomic_file.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The row of a run, and the time that it took of this thread's processor, which other processes share without
/// lengthening it.
struct FinishedRun {
  std::string row;
  double seconds = 0.0;
};

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

fs::path run_folder(const SweepOptions& options, std::size_t run) {
  return options.directory / "runs" / fmt::format("{:06}", run);
}

FinishedRun compute(const SweepPlan& plan, const SweepOptions& options, std::size_t run) {
  const LoadedScenario loaded = plan.cases.load(run);
  const auto shell = make_shell(loaded.scenario, loaded.files);
  std::optional<fs::path> output;
  if (options.keep_runs) output = run_folder(options, run);
  const double before = processor_seconds();
  const RunReport report = run_with_shell(loaded, shell, output, false);
  double seconds = processor_seconds() - before;
  constexpr double kShort = 0.005;  // [s]
  for (int more = options.timed && seconds < kShort ? 4 : 0; more > 0; --more) {
    const double again = processor_seconds();
    run_with_shell(loaded, shell, std::nullopt, false);
    seconds = std::min(seconds, processor_seconds() - again);
  }
  return {finished_row(plan, run, report.summary), seconds};
}

}  // namespace

fs::path table_of(const SweepOptions& options) {
  return options.directory / table_name(options.shard);
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  const Shard part = options.part();
  SweepReport report;
  report.table = table_of(options);
  const auto keep = [&](std::size_t run, std::string_view text) {
    return sweep_row(plan, text).outcome != kErrorOutcome &&
           (!options.keep_runs || fs::exists(run_folder(options, run) / "summary.json"));
  };
  TableFile table({report.table, fmt::format("{}", fmt::join(sweep_columns(plan), ",")), plan.description(part),
                   plan.cases.size(), true},
                  options.resume ? TableFile::Keep(keep) : nullptr);
  report.resumed = table.count();
  const std::size_t size = part.size(plan.cases.size());
  ProgressBar bar("sweep", size, options.progress);
  bar.start_at(report.resumed);
  const auto work = [&](std::size_t run) -> TableRow {
    try {
      FinishedRun finished = compute(plan, options, run);
      return {std::move(finished.row), [&, run, seconds = finished.seconds] {
                if (options.timed) options.timed(run, seconds);
                bar.show(table.count(), true);
              }};
    } catch (const IoError&) {
      throw;  // further runs could not be kept either; --resume goes on
    } catch (const std::exception& error) {
      return {error_row(plan, run), [&, run, problem = std::string(error.what())] {
                if (!report.failed || run < report.failed->run) report.failed = FailedRun{run, problem};
              }};
    }
  };
  for_each(plan.cases, part, options.jobs, table, work);
  report.done = table.count();
  if (report.done < size) {
    report.signal = StopSignal::received();
    return report;
  }
  table.finish([&](std::string_view text) {
    SweepRow row = sweep_row(plan, text);
    report.counts.add(row);
    if (size <= SweepReport::kMostRows) report.rows.push_back(std::move(row));
  });
  return report;
}

}  // namespace hapbench
