#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <exception>
#include <nlohmann/json.hpp>
#include <numeric>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/text_lines.hpp"
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

/// Which runs of the shard have a row: two bits a run.
class Rows {
 public:
  Rows(const SweepPlan& plan, const Shard& shard)
      : shard_(shard), has_(shard.size(plan.points.size())), failed_(has_.size()) {}

  std::size_t count() const { return count_; }
  std::size_t size() const { return has_.size(); }
  bool has(std::size_t run) const { return has_[run / shard_.count]; }
  bool has_failed(std::size_t run) const { return failed_[run / shard_.count]; }
  void set(std::size_t run, bool has_failed) {
    if (!has(run)) ++count_;
    has_[run / shard_.count] = true;
    failed_[run / shard_.count] = has_failed;
  }

 private:
  Shard shard_;
  std::vector<bool> has_, failed_;
  std::size_t count_ = 0;
};

/// Records a row that was found in the journal. Refuses rows that are not of this sweep, since somebody may have edited
/// the file.
void note(Rows& rows, const SweepPlan& plan, const Shard& shard, const fs::path& file, std::string_view row) {
  const auto known = parse_row(plan, row);
  if (!known || !shard.has(known->run))
    fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
  rows.set(known->run, false);
}

/// Finds the rows of runs in the journal. Knows the places of some rows at a time and reads the journal anew for the
/// next ones, so that its memory does not grow with the sweep.
class RowFinder {
 public:
  /// Precondition: the journal is flushed and gets no further rows.
  RowFinder(Journal& journal, const Shard& shard, std::size_t most_places)
      : journal_(journal), shard_(shard), places_(most_places) {
    find_from(0);
  }

  /// Precondition: the run has a row in the journal.
  std::string row(std::size_t run) {
    const std::size_t number = run / shard_.count;
    if (number - first_ >= places_.size()) find_from(number);
    return journal_.row_at(places_[number - first_]);
  }

 private:
  void find_from(std::size_t first) {
    first_ = first;
    journal_.read_rows([this](Journal::Place place, std::string_view row) {
      const std::size_t run = whole_number(row.substr(0, row.find(','))).value();
      const std::size_t number = run / shard_.count - first_;  // of an earlier row it wraps around
      if (number < places_.size()) places_[number] = place;
    });
  }

  Journal& journal_;
  Shard shard_;
  std::vector<Journal::Place> places_;
  std::size_t first_ = 0;
};

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
  RunOrder order(plan.points, options.part());
  ProgressBar bar("sweep", rows.size(), options.progress);
  bar.start_at(rows.count());
  const auto deliver = [&](std::size_t run, const FinishedRun& finished) {
    journal.add(finished.row);
    rows.set(run, false);
    unwritten += finished.time;
    if (options.timed) options.timed(run, finished.seconds);
    if (unwritten >= kMostUnwritten) {
      journal.flush();
      unwritten = {};
    }
    bar.show(rows.count(), true);
  };
  const auto deliver_failure = [&](std::size_t run, const std::string& problem) {
    rows.set(run, true);
    if (!report.failed || run < report.failed->run) report.failed = FailedRun{run, problem};
  };
  std::exception_ptr cannot_write;  ///< further runs could not be kept either; --resume goes on
  const auto next = [&]() -> std::optional<std::size_t> {
    if (cannot_write || StopSignal::received() != 0) return std::nullopt;
    auto run = order.next();
    while (run && rows.has(*run)) run = order.next();
    return run;
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

RunOrder::RunOrder(const SweepPoints& points, const Shard& shard) : points_(points), shard_(shard) {
  const std::vector<Axis>& axes = points.axes();
  for (const bool of_environment : {true, false})
    for (std::size_t a = 0; a < axes.size(); ++a)
      if (is_of_environment(axes[a]) == of_environment) axes_.push_back(a);
  if (!points.sampling()) return;
  // Each point of a sampled range has a value of its own, which no other run shares.
  const auto places = [&](std::size_t run) {
    std::vector<std::size_t> numbers;
    for (const std::size_t a : axes_)
      if (is_of_environment(axes[a]) && axes[a].size() > 0) numbers.push_back(points.place(run, a));
    return numbers;
  };
  if (places(0).empty()) return;
  sorted_.resize(points.size());
  std::iota(sorted_.begin(), sorted_.end(), std::size_t{0});
  std::stable_sort(sorted_.begin(), sorted_.end(), [&](std::size_t a, std::size_t b) { return places(a) < places(b); });
}

std::optional<std::size_t> RunOrder::next() {
  while (count_ < points_.size()) {
    const std::size_t number = count_++;
    const std::size_t run =
        points_.sampling() ? sorted_.empty() ? number : sorted_[number] : points_.run(number, axes_);
    if (shard_.has(run)) return run;
  }
  return std::nullopt;
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
  Journal journal(file, journal_title(plan, options.part(), options.keep_runs), options.resume,
                  [&](Journal::Place, std::string_view row) { note(rows, plan, options.part(), file, row); });
  SweepReport report;
  report.resumed = rows.count();
  compute_rows(plan, options, journal, rows, report);
  if (report.signal != 0) return report;
  report.table = options.directory / (stem + ".csv");
  FileSet files;
  files.write(options.directory / (stem + ".json"), json_text(sweep_description(plan, options.part())));
  RowFinder finder(journal, options.part(), std::min(rows.size(), options.most_places));
  const auto row_of = [&](std::size_t run) {
    std::string text = rows.has_failed(run) ? row_text(plan, error_row(plan, run)) : finder.row(run);
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
