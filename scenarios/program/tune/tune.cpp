#include "scenarios/program/tune/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/tune/columns.hpp"
#include "scenarios/program/tune/json.hpp"
#include "scenarios/program/tune/question.hpp"
#include "scenarios/program/tune/text.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

void tune_laws(const std::vector<std::string>& algorithms, bool quiet, Tuning& tuning) {
  std::atomic<std::size_t> law = 0, runs = 0;
  const auto now = [&] {
    const std::size_t i = std::min(law.load(), algorithms.size() - 1);
    return fmt::format("tune: {} ({} of {}), {} runs", algorithms[i], i + 1, algorithms.size(), runs.load());
  };
  const WaitNotice notice(now, !quiet);
  tuning.question.on_runs = [&](std::size_t count) { runs = count; };
  for (law = 0; law < algorithms.size(); ++law) {
    tuning.runs += tuning.laws.emplace_back(tuned_law(tuning.question, algorithms[law])).runs;
    tell_progress("tune", law + 1, algorithms.size());
  }
  tuning.question.on_runs = {};
  tuning.ranking = ranking_of(tuning.laws);
}

int tune(const TuneOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  const std::filesystem::path file = find_scenario(options.scenario);
  Tuning tuning;
  tuning.question = tune_question(options, file);
  const std::string device = device_text(options.device, tuning.question);
  const LoadedScenario loaded = checked(load_scenario(tuning.question.scenario, tuning.question.overrides));
  const std::vector<std::string> algorithms = options.algorithms.empty()
                                                  ? std::vector<std::string>{loaded.scenario.rendering.algorithm}
                                                  : chosen_algorithms(options.algorithms);
  print_warnings(context, loaded);
  tuning.scene = loaded.scenario.name + device;
  tuning.ranges = with_file(loaded, [&] { return tune_ranges(tuning.question, algorithms.front()); });
  Report report(options, "tune_" + file.stem().string(), context);
  const std::filesystem::path& out = report.folder();
  tune_laws(algorithms, options.output.quiet, tuning);
  report.write("tune.csv", tuned_columns(), tuning.laws);
  std::vector<TuneTrial> trials;
  for (const TunedLaw& law : tuning.laws) trials.insert(trials.end(), law.trials.begin(), law.trials.end());
  report.write("tune_trials.csv", trial_columns(), trials);
  report.say(tuning_text(tuning, layout));
  if (const std::string delay = delay_note(loaded.scenario); !delay.empty()) report.say(layout.wrapped(delay, 0));
  std::filesystem::path tuned;
  if (!tuning.ranking.empty()) {
    tuned = out / (file.stem().string() + "_tuned.json");
    report.files().write(tuned, json_text(tuned_scenario(tuning, *tuning.ranking[0], out)));
    report.say(fmt::format("\"hapbench run {}\" gives these metrics\n", tuned.string()));
  }
  report.say(fmt::format("results in {0}\n\"hapbench plot {0}\" draws them\n", out.string()));
  report.json() = tuning_json(tuning, tuned);
  return report.finish();
}

}  // namespace

void add_tune(CommandLine& line) {
  auto [command, options] =
      line.command("tune", "Say which stiffness and damping to use, in a scene on a device", tune);
  command.add("scenario", options.scenario, "scenario file, or name of a bundled scenario", {.required = true});
  command.add("--device", options.device, "a preset, ideal, admittance, or a file NAME.json (default: the scene's)");
  add_algorithms(command, options.algorithms, "the scene's own");
  command.add("--margin", options.question.margin, "settled up to so many times K (default: 2)");
  command.add("--bound", options.bounds,
              "what the choice has to keep: metric=most or metric=least:most, as inside_max_m=3e-4 [m], "
              "force_rms_above_30Hz_N=0.05 or settled_force_step_max_N=0.2; repeatable");
  command.add("--family", options.family,
              "families of runs that have to hold: hands, seeds, speeds, or all (default: hands)",
              {.comma_separated = true});
  command.add("--damping-ratio", options.damping_ratio,
              "a:b, range of zeta; on an impedance device by the mass of its handle (default: 0.01:10)");
  command.add("--mass", options.mass,
              "a:b, range of the virtual mass on an admittance device [kg] (default: half to twice the scene's)");
  command.flag("--filters", options.question.filters, "on an impedance device also choose the velocity filter");
  add_common(command, options, "tune_NAME");
  command.footer(fmt::format(
      "For each law the largest K, over zeta (and virtual mass on an admittance device), at which the scene's own "
      "run and each of the family is settled (\"hapbench describe stability\"; where a script moves the tool, no "
      "more than 1 mm/s rms above 30 Hz at the handle) at K and at margin x K, the loop of device, hand and surface "
      "while they touch is stable as far by its eigenvalues, and all limits are kept at K; without limits of yours "
      "the own run is quiet, by the rules of \"hapbench describe diagnosis\": buzz, pop, chatter, energy. Hands are "
      "springs of 100 and 1000 N/m, on an impedance device's handle with 0.1 and 0.5 kg; the loop's, also none. "
      "Recommended is the law that settles least deep; on springs, the one that renders most stiffness. At most {} "
      "runs a law search. The choice is verified by {} runs of full length between K and margin x K, and by longer "
      "ones; it keeps your limits by as much as half the step, half the spacing and a look at the depth in every row "
      "move a number. Where nothing is feasible, it says which limit to relax. Files: tune.csv, tune_trials.csv, "
      "NAME_tuned.json, which run takes.",
      kMostTuneRuns, kTriedBetween + kTriedNear));
}

}  // namespace hapbench
