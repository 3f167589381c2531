#include "scenarios/program/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "algorithms/registry.hpp"
#include "results/io/atomic_file.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/renderer/loop_log.hpp"
#include "scenarios/renderer/replayed_passage.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// A row of replay_comparison.csv: the outputs of one algorithm along a log.
struct ReplayRow {
  std::string algorithm;
  ReplayComparison compared;    ///< comparison with the recorded outputs
  double largest_force = 0.0;   ///< [N]
  double rms_force = 0.0;       ///< [N]
  double largest_change = 0.0;  ///< largest change of the force between two calls [N]
  std::size_t faults = 0, stale = 0, clamped = 0;
};

ReplayRow replay_row(std::string algorithm, const std::vector<HapbenchOutput>& outputs, const LoopLog& log) {
  ReplayRow row;
  row.algorithm = std::move(algorithm);
  row.compared = compare_outputs(outputs, log.outputs);
  double squares = 0.0;
  Vec3 last = Vec3::Zero();  // the force before the first call
  for (const HapbenchOutput& output : outputs) {
    const Vec3 force = Eigen::Map<const Vec3>(output.force);
    row.largest_force = std::max(row.largest_force, force.norm());
    row.largest_change = std::max(row.largest_change, (force - last).norm());
    squares += force.squaredNorm();
    last = force;
    row.faults += output.status == HAPBENCH_FAULT;
    row.stale += output.status == HAPBENCH_STALE;
    row.clamped += output.status == HAPBENCH_CLAMPED;
  }
  row.rms_force = std::sqrt(squares / static_cast<double>(outputs.size()));
  return row;
}

Columns<ReplayRow> replay_columns() {
  return {{"algorithm", "", "force algorithm", &ReplayRow::algorithm, under("algorithm")},
          {"calls", "1", "calls of the renderer in the log", [](const ReplayRow& r) { return r.compared.calls; }},
          {"equal_calls", "1", "calls whose outputs are equal to the recorded ones to the last bit",
           [](const ReplayRow& r) { return r.compared.equal; }, under("equal\ncalls")},
          {"loop_force_difference_max_N", "N", "largest norm of the difference to the recorded force",
           [](const ReplayRow& r) { return r.compared.largest; }, under("difference\n[N]")},
          {"loop_force_max_N", "N", "largest norm of the force", &ReplayRow::largest_force, under("force max\n[N]")},
          {"loop_force_rms_N", "N", "root of the mean squared norm of the force, over all calls", &ReplayRow::rms_force,
           under("force rms\n[N]")},
          {"loop_force_change_max_N", "N", "largest norm of the change of the force between two calls",
           &ReplayRow::largest_change, under("change max\n[N]")},
          {"fault_calls", "1", "calls with the status FAULT", &ReplayRow::faults, under("FAULT")},
          {"stale_calls", "1", "calls with the status STALE", &ReplayRow::stale, under("STALE")},
          {"clamped_calls", "1", "calls with the status CLAMPED", &ReplayRow::clamped, under("CLAMPED")}};
}

/// Returns the time between the first call of the log and call `i` [s].
double time_of(const LoopLog& log, std::size_t i) {
  return 1e-9 * static_cast<double>(log.inputs[i].time_ns - log.inputs.front().time_ns);
}

/// Result of rendering the calls of a log with a scenario.
struct Replayed {
  std::vector<HapbenchOutput> outputs;
  std::string header;  ///< header of a log with these outputs
  ReplayedPassage passage;
};

Replayed rendered(const CheckedScenario& scenario, const LoopLog& log) {
  const std::unique_ptr<HapbenchRenderer> renderer(
      with_file(scenario.loaded(), [&] { return new_renderer(scenario, log.setup); }));
  ReplayedPassage passage(scenario);
  const auto add = [&](std::size_t i, const HapbenchOutput& output) {
    passage.add(renderer->live, output, time_of(log, i));
  };
  std::vector<HapbenchOutput> outputs = replayed(*renderer, log, add);
  return {std::move(outputs), renderer->log_header, std::move(passage)};
}

/// Warns if the tool passed through the surface. `what`: the log, or the log and the algorithm.
void warn_of_passage(const ProgramContext& context, const std::string& what, const ReplayedPassage& passage) {
  if (const std::string text = passage.text(); !text.empty())
    print_warnings(context, {fmt::format("{}: the tool passed through the surface: {}; the forces after this time may "
                                         "push it to the other side",
                                         what, text)});
}

std::string hash_of(const LoadedScenario& loaded) {
  return scenario_hash(effective_scenario(loaded.scenario, fs::current_path()), loaded.files);
}

/// Returns a sentence on the difference between a scenario, whose hash is `hash`, and the recorded scenario; empty if
/// they are the same.
std::string other_scenario_note(const Scenario& scenario, const std::string& hash, const LoopLog& log) {
  const bool has_other_period = scenario.time.step != log.scenario.period;
  if (hash == log.scenario.hash && !has_other_period) return "";
  std::string text =
      fmt::format("the log was recorded with another scenario ({}, hash {}; here {}, hash {}): forces may differ",
                  log.scenario.name, log.scenario.hash, scenario.name, hash);
  if (has_other_period)
    text += fmt::format(". The recorded time step is {0} s, here it is {1} s: --set time.step_s={0}",
                        log.scenario.period, scenario.time.step);
  return text;
}

std::string other_scenario_note(const CheckedScenario& scenario, const LoopLog& log) {
  return other_scenario_note(scenario.scenario(), hash_of(scenario.loaded()), log);
}

/// Returns the note for a comparison of laws; empty if the scenario differs from the recorded scenario only in its law.
std::string other_scenario_note(const fs::path& file, std::vector<std::string> overrides, const LoopLog& log) {
  const LoadedScenario given = load_scenario(file, overrides);
  const std::string own = hash_of(given);
  std::erase_if(overrides, [](const std::string& text) { return text.starts_with("rendering.algorithm="); });
  const auto is_recorded = [&](const std::vector<std::string>& fields) {
    try {
      return hash_of(load_scenario(file, fields)) == log.scenario.hash;
    } catch (const InputError&) {  // a scenario that rejects the law recorded no log with it
      return false;
    }
  };
  // Load the scenario with each law as for a recording: an override may change more fields than its own.
  const auto is_recorded_with = [&](const std::string& law) {
    std::vector<std::string> fields = overrides;
    fields.push_back("rendering.algorithm=" + law);
    return is_recorded(fields);
  };
  const bool is_same =
      own == log.scenario.hash || is_recorded(overrides) || std::ranges::any_of(algorithm_names(), is_recorded_with);
  return other_scenario_note(given.scenario, is_same ? log.scenario.hash : own, log);
}

/// Returns sentences on the calls of the log and on the comparison of the outputs. `period`: time step of the scenario
/// that renders the log [s].
std::string summary_text(const ReplayRow& row, const LoopLog& log, const std::string& file, double period) {
  const double seconds = time_of(log, log.inputs.size() - 1);
  std::string text = fmt::format(
      "{}: {} calls in {:.6g} s, {} mode, mean period {:.6g} ms (scenario: {:.6g} ms)\n", file, log.inputs.size(),
      seconds, mode_name(log.setup.mode),
      log.inputs.size() > 1 ? 1e3 * seconds / static_cast<double>(log.inputs.size() - 1) : 0.0, 1e3 * period);
  text += row.compared.equal == row.compared.calls
              ? "all outputs are equal to the recorded ones to the last bit\n"
              : fmt::format("{} of {} calls have other outputs than recorded, the first is call {}\n",
                            row.compared.calls - row.compared.equal, row.compared.calls, row.compared.first_other);
  return text;
}

}  // namespace

int replay_loop(const std::string& given, const std::string& log_file, const CommonOptions& options,
                ProgramContext& context) {
  const fs::path file = find_scenario(given);
  const LoopLog log = read_loop_log(log_file);
  const CheckedScenario scenario = checked(load_scenario(file, options.overrides));
  print_warnings(context, scenario);
  Report report(options, "replay", file.stem().string() + "_replay", context);
  const auto [outputs, header, passage] = rendered(scenario, log);
  warn_of_passage(context, log_file, passage);
  // Write the log with the new outputs.
  AtomicFile written(report.folder() / "replay.csv");
  written.append(header);
  for (std::size_t i = 0; i < outputs.size(); ++i) written.append(log_row(log.inputs[i], outputs[i]));
  report.files().take(std::move(written));
  // Compare the new outputs with the recorded outputs.
  const ReplayRow row = replay_row(scenario.scenario().rendering.algorithm, outputs, log);
  const std::string other = other_scenario_note(scenario, log);
  const Layout layout = context.layout();
  report.add_text(summary_text(row, log, log_file, scenario.scenario().time.step) + "\n");
  report.show(replay_columns().table(std::vector{row}, "forces along the log " + log_file, layout.in_full()));
  if (!other.empty()) report.add_text("\n" + layout.wrapped(other, 0));
  report.add_text(fmt::format("\nresults in {}\n", report.folder().string()));
  report.json() = replay_columns().json(row);
  report.json()["is_recorded_scenario"] = other.empty();
  report.json()["went_through"] = passage.went_through() ? Json(*passage.went_through()) : Json();
  if (other.empty() && row.compared.equal != row.compared.calls)
    report.fault(fmt::format("{}: call {} has other outputs than recorded, although the scenario is the same; the log "
                             "was edited, or another version recorded it",
                             log_file, row.compared.first_other),
                 kUnexpectedOutcome);
  return report.finish();
}

int compare_replays(const std::string& given, const std::string& log_file, const std::vector<std::string>& algorithms,
                    const CommonOptions& options, ProgramContext& context) {
  const fs::path file = find_scenario(given);
  const LoopLog log = read_loop_log(log_file);
  // Check every scenario before anything is rendered.
  std::vector<CheckedScenario> scenarios;
  for (const std::string& algorithm : algorithms) {
    LoadedScenario loaded = load_scenario(file, options.overrides);
    loaded.scenario = with_algorithm(std::move(loaded.scenario), algorithm);
    scenarios.push_back(checked(std::move(loaded)));
  }
  Report report(options, "compare_replay", "compare_" + file.stem().string() + "_replay", context);
  if (const std::string other = other_scenario_note(file, options.overrides, log); !other.empty())
    print_warnings(context, {fmt::format("{}: {}", log_file, other)});
  std::vector<ReplayRow> rows;
  for (const CheckedScenario& scenario : scenarios) {
    const std::string& algorithm = scenario.scenario().rendering.algorithm;
    const Replayed replayed = rendered(scenario, log);
    // In impedance mode, the tool moves identically with all laws, so that one warning suffices.
    const bool depends_on_law = log.setup.mode == HAPBENCH_ADMITTANCE;
    if (depends_on_law || rows.empty())
      warn_of_passage(context, depends_on_law ? fmt::format("{}, {}", log_file, algorithm) : log_file,
                      replayed.passage);
    rows.push_back(replay_row(algorithm, replayed.outputs, log));
  }
  report.write("replay_comparison.csv", replay_columns(), rows);
  const Layout layout = context.layout();
  report.add_text(
      layout.wrapped(
          fmt::format("forces of each law along the motion in {}, recorded with {}", log_file, log.scenario.name), 0) +
      "\n");
  report.show(replay_columns().table(rows, "forces of each law along the log " + log_file, layout.in_full()));
  report.add_text(fmt::format("\nresults in {}\n", report.folder().string()));
  report.json() = replay_columns().json_list(rows);
  return report.finish();
}

std::vector<DescribedTable> replay_tables() {
  return {replay_columns().described("replay_comparison.csv", "written by compare --replay: one line per algorithm")};
}

}  // namespace hapbench
