#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/runs_to_do.hpp"
#include "scenarios/batch/sweep_row.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The rows of the shard's runs: which there are, and where.
class Rows {
 public:
  Rows(const SweepPlan& plan, const Shard& shard)
      : plan_(plan), shard_(shard), places_(shard.size(plan.points.size()), kNone) {}

  std::size_t count() const { return count_; }
  std::size_t size() const { return places_.size(); }
  bool has(std::size_t run) const { return places_[run / shard_.count] != kNone; }
  void set(std::size_t run, Journal::Place place) {
    if (!has(run)) ++count_;
    places_[run / shard_.count] = place;
  }
  void set_failed(std::size_t run) { set(run, kFailed); }
  /// Precondition: there is one, and the journal is written.
  std::string row(std::size_t run, const Journal& journal) const {
    const Journal::Place place = places_[run / shard_.count];
    return place == kFailed ? error_row(plan_, run) : journal.row_at(place);
  }

 private:
  static constexpr Journal::Place kNone = 0;
  static constexpr Journal::Place kFailed = ~Journal::Place{0};

  const SweepPlan& plan_;
  Shard shard_;
  std::vector<Journal::Place> places_;
  std::size_t count_ = 0;
};

/// Notes a row that the journal holds. Its first line is right, but somebody may have written to it.
void note(Rows& rows, const SweepPlan& plan, const Shard& shard, const fs::path& file, Journal::Place place,
          std::string_view row) {
  const auto run = run_of_row(plan, row);
  if (!run || !shard.has(*run)) {
    fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
  }
  rows.set(*run, place);
}

/// A run on its way from the threads to the journal.
struct FinishedRun {
  std::string row;
  std::chrono::steady_clock::duration time;
};

FinishedRun compute(const SweepPlan& plan, const SweepOptions& options, std::size_t run) {
  const auto start = std::chrono::steady_clock::now();
  const LoadedScenario loaded = scenario_of(plan, run);
  const auto shell = make_shell(loaded.scenario, loaded.files);
  std::optional<fs::path> output;
  if (options.keep_runs) output = options.directory / "runs" / fmt::format("{:06}", run);
  std::string row = sweep_row(plan, run, run_with_shell(loaded, shell, output, false).summary);
  return {std::move(row), std::chrono::steady_clock::now() - start};
}

/// Does the runs that have no row yet.
void compute_rows(const SweepPlan& plan, const SweepOptions& options, Journal& journal, Rows& rows,
                  SweepReport& report) {
  // A file is written to after so much work, not after each run: that would take 1 % of a short one.
  constexpr std::chrono::milliseconds kMostUnwritten(10);
  std::chrono::steady_clock::duration unwritten{};
  RunsToDo runs(plan.points, options.part());
  ProgressBar bar("sweep", rows.size(), options.progress);
  bar.start_at(rows.count());
  const auto deliver = [&](std::size_t run, const FinishedRun& finished) {
    rows.set(run, journal.add(finished.row));
    unwritten += finished.time;
    if (unwritten >= kMostUnwritten) {
      journal.flush();
      unwritten = {};
    }
    bar.show(rows.count(), true);
  };
  const auto deliver_failure = [&](std::size_t run, const std::string& problem) {
    rows.set_failed(run);
    if (!report.failed || run < report.failed->run) report.failed = FailedRun{run, problem};
  };
  const auto next = [&]() -> std::optional<std::size_t> {
    while (StopSignal::received() == 0) {
      const auto run = runs.next();
      if (!run || !rows.has(*run)) return run;
    }
    return std::nullopt;
  };
  const auto work = [&](std::size_t run) -> Delivery {
    try {
      return [&deliver, run, finished = compute(plan, options, run)] { deliver(run, finished); };
    } catch (const Stopped&) {
      return {};  // --resume computes it
    } catch (const std::exception& error) {
      return [&deliver_failure, run, problem = std::string(error.what())] { deliver_failure(run, problem); };
    }
  };
  parallel_for(next, options.jobs, work);
  journal.flush();
  report.done = rows.count();
  if (report.done < rows.size()) report.signal = StopSignal::received();
}

}  // namespace

std::string stem_of(const std::optional<Shard>& shard) {
  return shard ? fmt::format("sweep_shard_{}_of_{}", shard->index, shard->count) : "sweep";
}

std::string journal_title(const SweepPlan& plan, const Shard& shard, bool keep_runs) {
  return fmt::format("definition {}, shard {}, {}", plan.definition, shard_text(shard),
                     keep_runs ? "runs are kept" : "runs are not kept");
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  const std::string stem = stem_of(options.shard);
  const fs::path file = options.directory / (stem + ".journal");
  Rows rows(plan, options.part());
  Journal journal(
      file, journal_title(plan, options.part(), options.keep_runs), options.resume,
      [&](Journal::Place place, std::string_view row) { note(rows, plan, options.part(), file, place, row); });
  remove_stale_temporaries(options.directory);
  SweepReport report;
  report.resumed = rows.count();
  compute_rows(plan, options, journal, rows, report);
  if (report.signal != 0) return report;
  report.table = options.directory / (stem + ".csv");
  write_file_atomically(options.directory / (stem + ".json"), json_text(sweep_description(plan, options.part())));
  write_sweep_table(report.table, plan, options.shard, [&](std::size_t run) {
    std::string row = rows.row(run, journal);
    report.counts.add(plan, run, row);
    if (rows.size() <= SweepReport::kMostRows) report.rows.push_back(row);
    return row;
  });
  journal.remove();
  return report;
}

}  // namespace hapbench
