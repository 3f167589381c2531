#include "scenarios/program/tune/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/shell_words.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/option_values.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/tune/columns.hpp"
#include "scenarios/program/tune/json.hpp"
#include "scenarios/program/tune/loop_lines.hpp"
#include "scenarios/program/tune/question.hpp"
#include "scenarios/program/tune/text.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

/// Tunes one law after the other, and ranks the laws. Shows the current law and the number of runs meanwhile.
void tune_laws(const std::vector<std::string>& algorithms, bool quiet, Tuning& tuning, const ProgramContext& context) {
  std::atomic<std::size_t> law = 0;
  std::mutex mutex;  // protects the progress within a law
  std::size_t runs = 0;
  std::string purpose;
  const auto now = [&] {
    const std::size_t i = std::min(law.load(), algorithms.size() - 1);
    const std::lock_guard lock(mutex);
    return fmt::format("tune: {} ({} of {}), {} runs, {}", algorithms[i], i + 1, algorithms.size(), runs, purpose);
  };
  const WaitNotice notice(now, !quiet);
  tuning.question.on_runs = [&](std::size_t count, const std::string& what) {
    const std::lock_guard lock(mutex);
    runs = count;
    purpose = what;
  };
  for (law = 0; law < algorithms.size(); ++law) {
    tuning.runs += tuning.laws.emplace_back(tuned_law(tuning.question, algorithms[law])).runs;
    if (context.progress != nullptr) (*context.progress)("tune", law + 1, algorithms.size());
  }
  tuning.question.on_runs = {};
  tuning.ranking = ranking_of(tuning.laws);
}

int tune(const TuneOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  const double scale = parse_bounded_number("--scale", options.scale, 1e-3, 1e3);
  const std::filesystem::path file = find_scenario(options.scenario);
  Tuning tuning;
  tuning.question = tune_question(options, file);
  const std::string device = device_text(options.device, tuning.question);
  const CheckedScenario scene = checked(load_scenario(tuning.question.scenario, tuning.question.overrides));
  const LoadedScenario& loaded = scene.loaded();
  const std::vector<std::string> algorithms = options.algorithms.empty()
                                                  ? std::vector<std::string>{loaded.scenario.rendering.algorithm}
                                                  : chosen_algorithms(options.algorithms);
  require_bounded_metrics(tuning.question.limits, {loaded});
  print_warnings(context, scene);
  tuning.scene = loaded.scenario.name + device;
  tuning.ranges = with_file(loaded, [&] { return tune_ranges(tuning.question, algorithms.front()); });
  Report report(options, "tune", "tune_" + file.stem().string(), context);
  const std::filesystem::path& out = report.folder();
  // Tune the laws and write their tables.
  tune_laws(algorithms, options.output.quiet, tuning, context);
  report.write("tune.csv", tuned_columns(tuning.question), tuning.laws);
  std::vector<TuneTrial> trials;
  for (const TunedLaw& law : tuning.laws) trials.insert(trials.end(), law.trials.begin(), law.trials.end());
  report.write("tune_trials.csv", trial_columns(), trials);
  // Write the scenario with the best choice. If no law has a feasible choice, remove the tuned scenario that an earlier
  // command may have written.
  const std::filesystem::path tuned_file = out / (file.stem().string() + "_tuned.json");
  std::filesystem::path tuned;
  Json tuned_json;
  if (tuning.ranking.empty()) report.files().remove(tuned_file);
  if (!tuning.ranking.empty()) {
    tuned = tuned_file;
    tuned_json = tuned_scenario(tuning, *tuning.ranking[0], out);
    report.files().write(tuned, json_text(tuned_json));
  }
  report_tuning(tuning, layout, report);
  if (const std::string delay = delay_note(loaded.scenario); !delay.empty()) report.add_text(layout.wrapped(delay, 0));
  if (!tuned.empty()) {
    report.add_text(fmt::format("\"hapbench run {}\" gives these metrics;\n", shell_file(tuned)));
    report.add_text(loop_lines(tuned_json, tuned, scale));
  }
  report.add_text(fmt::format("results in {}\n\"hapbench plot {}\" draws them\n", out.string(), shell_file(out)));
  report.json() = tuning_json(tuning, tuned);
  if (!tuned.empty() && scale != 1.0) report.json()["loop_overrides"] = overrides_for_scale(tuned_json, scale);
  return report.finish();
}

}  // namespace

void add_tune(CommandLine& line) {
  auto [command, options] = line.command(
      "tune",
      "Find the largest stiffness K, with its damping and force law, that keeps a margin to the stability limit.",
      tune);
  command.add("scenario <scenario>", options.scenario, "scenario file or name of a bundled scenario",
              {.required = true});
  command.add("--device <name>", options.device,
              "a preset, ideal, admittance, or a file NAME.json (default: the scenario's device)");
  add_algorithms(command, options.algorithms, "the scenario's algorithm");
  command.add("--margin <factor>", options.question.margin,
              "runs must be stable at K and at this factor times K (default: 2; more than 1, at most 16)");
  command.add("--bound <metric=range>", options.bounds,
              "runs at K must keep METRIC=MAX or METRIC=MIN:MAX, such as inside_max_m=3e-4 or "
              "force_rms_above_30Hz_N=0.05; repeatable");
  command.flag("--allow-vibration", options.question.allow_vibration,
               "do not require low vibration of the scenario's run at K and slightly below");
  command.add("--family <name,...>", options.family,
              "further runs that must be stable: hands, seeds, speeds, or all (default: hands)",
              {.comma_separated = true});
  command.add("--damping-ratio <a:b>", options.damping_ratio,
              "range of the damping ratio zeta of the virtual mass rendering.mass_kg (default: 0.01:10)");
  command.add("--mass <a:b>", options.mass,
              "range of the virtual mass on an admittance device [kg] (default: half to twice the scenario's)");
  command.add(
      "--scale <number>", options.scale,
      "scale of motion of your own loop, setup.mount.scale in scenarios/LOOP.md (default: 1); tune prints lines of "
      "code for this loop, with all coefficients divided by the scale");
  command.flag("--filters", options.question.filters, "on an impedance device, choose the velocity filter too");
  add_common(command, options, "tune_NAME");
  add_table(command, options.output);
  command.footer(fmt::format(
      "Time step: time.step_s of the scenario is the period of the loop; for a loop of 1 kHz, --set "
      "time.step_s=0.001.\n\n"
      "Requirements: the scenario's run and the runs of each family are stable at K and at margin x K, the linear "
      "limit is at least margin x K, every --bound holds at K, and a force is rendered. The scenario's run at K does "
      "not fail: none of the rules {} applies (\"hapbench describe diagnosis\"). Unless --allow-vibration is given, "
      "the scenario's run has low vibration at K and at {} stiffnesses from {:g} K to K: none of the rules {} "
      "applies.\n\n"
      "Result: K, zeta and law, the binding constraint, the margins that are left, and the expected metrics with their "
      "errors. {} verification samples between K and margin x K must be stable; otherwise the search continues with "
      "another K.\n\n"
      "Several laws: tune recommends the law with the smallest depth of the tool in settled contact "
      "(inside_settled_m). If this depth is not known, tune recommends the law that renders the largest stiffness.\n\n"
      "Nothing feasible: tune names the bound to relax, with a value that a second search confirms, or the failing run "
      "and the option that can help.\n\n"
      "Files: NAME_tuned.json is the tuned scenario, for \"hapbench run\". tune.csv has one row per law, "
      "tune_trials.csv one row per trial. They replace the files of an earlier tune in the same folder; if nothing is "
      "feasible, an earlier NAME_tuned.json is removed.\n\n"
      "Time: seconds to minutes if \"hapbench run\" takes less than 0.1 s, and hours if it takes seconds. A search for "
      "a law ends after {} runs; verification, error estimates and, if nothing is feasible, searches with other bounds "
      "come in addition.\n\n"
      "Exit status: 0 also if nothing is feasible; 2 bad input; 130 stopped by Ctrl-C.",
      rule_names(RuleKind::failure), kLowVibrationSamples, kLowVibrationFrom, rule_names(RuleKind::low_vibration),
      kVerificationSamples + kSamplesNearLimit, kMaxTuneRuns));
}

}  // namespace hapbench
