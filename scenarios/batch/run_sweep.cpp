#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path run_folder(const SweepOptions& options, std::size_t run) {
  return options.directory / "runs" / fmt::format("{:06}", run);
}

/// The line of a run, without its end: its number and varied fields, and these cells behind them.
std::string line_of(const SweepPlan& plan, std::size_t run, const std::vector<std::string>& cells) {
  std::string line = std::to_string(run);
  for (const std::string& value : plan.cases.values(run)) line += "," + csv_cell(value);
  for (const std::string& cell : cells) line += "," + cell;
  return line;
}

std::string error_row(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = {std::string(kErrorOutcome), "false"};
  cells.resize(plan.columns().size() - plan.cases.axes().size() - 1);
  return line_of(plan, run, cells);
}

std::string finished_row(const SweepPlan& plan, std::size_t run, const Result& summary) {
  std::vector<std::string> cells = {std::string(outcome_name(summary.end.outcome)), summary.expected ? "true" : "false",
                                    std::to_string(summary.end.rows)};
  const MetricList& metrics = summary.metrics;
  auto next = metrics.begin();  // the columns are in the same order, but some runs have more metrics than others
  for (const std::string& name : plan.metrics) {
    const bool is_it = next != metrics.end() && next->name == name;
    cells.push_back(is_it ? cell_text(next->value) : "");
    if (is_it) ++next;
  }
  if (next != metrics.end()) {
    throw InputError(
        fmt::format("has the metric {}, for which no run that was checked before the first one has a column; allowed: "
                    "sweeps whose first runs record what the others record",
                    next->name));
  }
  for (const std::string& name : plan.bounded) {
    const Metric* metric = find_metric(metrics, name);
    const auto tolerance = metric != nullptr ? metric->tolerance() : std::nullopt;
    cells.push_back(tolerance ? cell_text(*tolerance) : "");
  }
  cells.push_back(hash_text(summary.state_hash));
  return line_of(plan, run, cells);
}

std::string computed_row(const SweepPlan& plan, const SweepOptions& options, std::size_t run) {
  const auto output = options.keep_runs ? std::optional(run_folder(options, run)) : std::nullopt;
  return finished_row(plan, run, run_scenario(plan.cases.load(run), output, false));
}

}  // namespace

fs::path table_of(const SweepOptions& options) {
  return options.directory / table_name(options.shard);
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  const Shard part = options.part();
  SweepReport report;
  const std::vector<std::string> columns = plan.columns();
  const auto keep = [&](std::size_t run, std::string_view text) {
    const std::vector<std::string> cells = csv_cells(text);
    if (cells.size() != columns.size())
      throw InputError(fmt::format("got the row \"{}\"; allowed: rows of this sweep", text.substr(0, 60)));
    return cells[1 + plan.cases.axes().size()] != kErrorOutcome &&
           (!options.keep_runs || fs::exists(run_folder(options, run) / "summary.json"));
  };
  TableFile table(
      {table_of(options), fmt::format("{}", fmt::join(columns, ",")), plan.description(part), plan.cases.size()},
      options.resume ? TableFile::Keep(keep) : nullptr);
  report.resumed = table.count();
  const std::size_t size = part.size(plan.cases.size());
  ProgressBar bar("sweep", size, options.progress);
  bar.start_at(report.resumed);
  const auto work = [&](std::size_t run) -> TableRow {
    try {
      return {computed_row(plan, options, run), [&] {
                if (options.added) options.added();
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
  if (report.done < size)
    report.signal = StopSignal::received();
  else
    table.finish();
  return report;
}

}  // namespace hapbench
