#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <exception>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

bool is_of_environment(const Axis& axis) {
  return axis.path == "environment" || axis.path.starts_with("environment.");
}

/// Journal offset of each finished row of the shard.
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
  /// Precondition: the run has a row, and the journal is flushed.
  std::string row(std::size_t run, Journal& journal) const {
    const Journal::Place place = places_[run / shard_.count];
    return place == kFailed ? row_text(plan_, error_row(plan_, run)) : journal.row_at(place);
  }

 private:
  static constexpr Journal::Place kNone = 0;
  static constexpr Journal::Place kFailed = ~Journal::Place{0};

  const SweepPlan& plan_;
  Shard shard_;
  std::vector<Journal::Place> places_;
  std::size_t count_ = 0;
};

/// Records a row that was found in the journal. Refuses rows that are not of this sweep, since somebody may have edited
/// the file.
void note(Rows& rows, const SweepPlan& plan, const Shard& shard, const fs::path& file, Journal::Place place,
          std::string_view row) {
  const auto known = parse_row(plan, row);
  if (!known || !shard.has(known->run))
    fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
  rows.set(known->run, place);
}

/// A finished run that is not yet in the journal.
struct FinishedRun {
  std::string row;
  std::chrono::steady_clock::duration time;
  double seconds = 0.0;  ///< of this thread's processor, which other processes share without lengthening it
};

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

FinishedRun compute(const SweepPlan& plan, const SweepOptions& options, std::size_t run) {
  const auto start = std::chrono::steady_clock::now();
  const LoadedScenario loaded = scenario_of(plan, run);
  const auto shell = make_shell(loaded.scenario, loaded.files);
  std::optional<fs::path> output;
  if (options.keep_runs) output = options.directory / "runs" / fmt::format("{:06}", run);
  const double before = processor_seconds();
  const RunReport report = run_with_shell(loaded, shell, output, false);
  double seconds = processor_seconds() - before;
  constexpr double kShort = 0.005;  // [s]
  for (int more = options.timed && seconds < kShort ? 4 : 0; more > 0; --more) {
    const double again = processor_seconds();
    run_with_shell(loaded, shell, std::nullopt, false);
    seconds = std::min(seconds, processor_seconds() - again);
  }
  return {row_text(plan, sweep_row(plan, run, report.summary)), std::chrono::steady_clock::now() - start, seconds};
}

/// Computes the runs that have no row yet.
void compute_rows(const SweepPlan& plan, const SweepOptions& options, Journal& journal, Rows& rows,
                  SweepReport& report) {
  // The journal is flushed after this much work, because flushing after each run would take 1 % of a short one.
  constexpr std::chrono::milliseconds kMostUnwritten(10);
  std::chrono::steady_clock::duration unwritten{};
  const std::vector<std::size_t> runs = runs_to_do(plan.points, options.part());
  ProgressBar bar("sweep", rows.size(), options.progress);
  bar.start_at(rows.count());
  const auto deliver = [&](std::size_t run, const FinishedRun& finished) {
    rows.set(run, journal.add(finished.row));
    unwritten += finished.time;
    if (options.timed) options.timed(run, finished.seconds);
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
  std::exception_ptr cannot_write;  ///< further runs could not be kept either; --resume goes on
  const auto next = [&, run = runs.begin()]() mutable -> std::optional<std::size_t> {
    while (run != runs.end() && rows.has(*run)) ++run;
    return run == runs.end() || cannot_write || StopSignal::received() != 0 ? std::nullopt : std::optional(*run++);
  };
  const auto work = [&](std::size_t run) -> Delivery {
    try {
      return [&deliver, run, finished = compute(plan, options, run)] { deliver(run, finished); };
    } catch (const Stopped&) {
      return {};  // --resume computes it
    } catch (const IoError&) {
      return [&cannot_write, error = std::current_exception()] { cannot_write = error; };
    } catch (const std::exception& error) {
      return [&deliver_failure, run, problem = std::string(error.what())] { deliver_failure(run, problem); };
    }
  };
  parallel_for(next, options.jobs, work);
  journal.flush();
  if (cannot_write) std::rethrow_exception(cannot_write);
  report.done = rows.count();
  if (report.done < rows.size()) report.signal = StopSignal::received();
}

}  // namespace

std::vector<std::size_t> runs_to_do(const SweepPoints& points, const Shard& shard) {
  std::vector<std::size_t> runs;
  for (std::size_t run = shard.index; run < points.size(); run += shard.count) runs.push_back(run);
  // A number for each combination of listed values. Each point of a sampled range has a value of its own.
  const auto environment = [&points](std::size_t run) {
    std::size_t number = 0;
    for (std::size_t a = 0; a < points.axes().size(); ++a) {
      const Axis& axis = points.axes()[a];
      if (is_of_environment(axis) && axis.size() > 0) number = number * axis.size() + points.place(run, a);
    }
    return number;
  };
  std::stable_sort(runs.begin(), runs.end(),
                   [&](std::size_t a, std::size_t b) { return environment(a) < environment(b); });
  return runs;
}

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
  SweepReport report;
  report.resumed = rows.count();
  compute_rows(plan, options, journal, rows, report);
  if (report.signal != 0) return report;
  report.table = options.directory / (stem + ".csv");
  FileSet files;
  files.write(options.directory / (stem + ".json"), json_text(sweep_description(plan, options.part())));
  const auto row_of = [&](std::size_t run) {
    std::string text = rows.row(run, journal);
    SweepRow row = parse_row(plan, text).value();
    report.counts.add(row);
    if (rows.size() <= SweepReport::kMostRows) report.rows.push_back(std::move(row));
    return text;
  };
  write_sweep_table(report.table, plan, options.shard, row_of, files);
  files.commit();
  journal.remove();
  return report;
}

}  // namespace hapbench
