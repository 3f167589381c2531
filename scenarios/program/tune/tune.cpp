#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>

#include "scenarios/analysis/tuning/tune.hpp"
#include "scenarios/input/bundled_files.hpp"
#include "scenarios/program/limit/limit.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct TuneOptions : CommonOptions {
  std::string scenario, device, damping_ratio, mass;
  std::vector<std::string> algorithms, bounds, family;
  TuneQuestion question;  ///< as far as options are its members
};

struct Tuning {
  TuneQuestion question;
  std::string scene;  ///< name of the scene, with that of the device
  TuneRanges ranges;  ///< of the first law
  std::vector<TunedLaw> laws;
  std::vector<const TunedLaw*> ranking;  ///< those with a choice, best first
  std::size_t runs = 0;                  ///< simulations in all
};

/// Best is the least settled depth, where the scene has none the largest K lambda_max.
std::vector<const TunedLaw*> ranking_of(const std::vector<TunedLaw>& laws) {
  std::vector<const TunedLaw*> ranking;
  for (const TunedLaw& law : laws)
    if (law.choice) ranking.push_back(&law);
  std::ranges::stable_sort(ranking, {}, [](const TunedLaw* law) {
    return value_in(law->choice->metrics, "inside_settled_m").value_or(-law->choice->rendered());
  });
  return ranking;
}

/// With the digits that the search leaves it.
std::string stiffness_text(const TuneTrial& choice) {
  return deserved(choice.stiffness, 0.005 * choice.stiffness);
}

constexpr const char* kRatioColumn = "rendering.damping_ratio";

struct Margin {
  const char *column, *unit, *meaning, *heading, *key, *words;
  std::optional<double> TuneMargins::*of;
  double most;
};
constexpr Margin kMargins[] = {
    {"gain_margin", "1", "largest factor on K, up to 64, at which all runs and the loop in contact are settled", "gain",
     "gain", "gain {}", &TuneMargins::gain, 0.99 * kMostGain},
    {"delay_margin_samples", "time steps", "likewise of further delay of the device, up to 64; empty without device",
     "delay", "delay_samples", "{} samples more delay", &TuneMargins::delay_samples, kMostDelay},
    {"damping_margin", "1", "damping ratio of the least damped mode of the loop in contact; empty without one", "",
     "damping_ratio", "least damped mode {}", &TuneMargins::damping_ratio, 2.0}};

/// What was chosen, and why not more; nothing where nothing is feasible.
Columns<TunedLaw> choice_columns() {
  using Row = TunedLaw;
  const auto of_choice = [](auto member) {
    return [member](const Row& r) { return r.choice ? cell_of(std::invoke(member, *r.choice)) : Cell(); };
  };
  const auto feasible = [](const Row& r) { return r.choice.has_value(); };
  const auto stiffness = [](const Row& r) { return r.choice ? stiffness_text(*r.choice) : "none"; };
  return {
      {"algorithm", "", "force algorithm", &Row::algorithm, under("algorithm")},
      {"feasible", "", "false when nothing that was tried keeps all constraints", feasible},
      {"stiffness_N_per_m", "N/m", "the largest K; empty when nothing is feasible", of_choice(&TuneTrial::stiffness)},
      {"K [N/m]", "N/m", "of tune: the largest stiffness that keeps margin and limits [N/m]", stiffness,
       only_printed()},
      {kRatioColumn, "1", "zeta with it; empty where it has no part", of_choice(&TuneTrial::damping_ratio),
       under("zeta", 3, kOnlyCsv)},
      {"damping_ratio", "1", "the same", of_choice(&TuneTrial::damping_ratio), kOnlyJson},
      {"mass_kg", "kg", "virtual mass with it, of an admittance device; else empty: the scene's",
       of_choice(&TuneTrial::mass)},
      {"velocity_filter", "", "with it, as JSON; empty: the scene's", of_choice(&TuneTrial::filter)},
      {"lambda_max", "1",
       "largest eigenvalue of the mean S in the end of the run: K lambda_max is the stiffness rendered",
       of_choice(&TuneTrial::lambda_max)},
      {"binding", "",
       "what a larger K does not keep: settled, margin, a limited metric, or range, the end of the search",
       &Row::binding},
      {"why", "", "the same in words", &Row::why},
      {"relax", "", "where nothing is feasible: which limit to relax, and to what", &Row::relax}};
}

Columns<TunedLaw> tuned_columns() {
  using Row = TunedLaw;
  Columns<Row> columns = choice_columns();
  for (const Margin& margin : kMargins) {
    columns.add({{margin.column, margin.unit, margin.meaning, [of = margin.of](const Row& r) { return r.margins.*of; },
                  under(margin.heading, 3, kOnlyCsv)}});
  }
  const auto may_fail = [](const Row& r) { return r.verified > 0 ? Cell(may_fail_share(kTriedBetween)) : Cell(); };
  const auto metric = [](const char* heading, const char* name, double factor) {
    const auto text = [=](const Row& r) {
      const auto value = r.choice ? value_in(r.choice->metrics, name, factor) : std::nullopt;
      return value ? number_text(*value, value_in(r.error, name, factor)) : "-";
    };
    return Columns<Row>::Entry(heading, "by name", name, text, only_printed());
  };
  columns.add(
      {{"verified", "1",
        fmt::format("full-length runs between K and G K, all settled, {} of them just below G K", kTriedNear),
        &Row::verified},
       {"may_fail_share", "1", "share of what lies between K and G K that may not be, with 95 % confidence", may_fail},
       {"runs", "1", "simulations in all", &Row::runs},
       metric("settled\ninside [mm]", "inside_settled_m", 1e3),
       metric("vibration\n[N rms]", "force_rms_above_30Hz_N", 1.0),
       metric("largest\nstep [N]", "settled_force_step_max_N", 1.0),
       {"binding", "", "of tune: what a larger K does not keep", &Row::binding, only_printed()}});
  return columns;
}

Columns<TuneTrial> trial_columns() {
  using Row = TuneTrial;
  Columns<Row> columns = {
      {"algorithm", "", "force algorithm", &Row::algorithm},
      {"stiffness_N_per_m", "N/m", "K", &Row::stiffness},
      {kRatioColumn, "1", "zeta; empty where it has no part", &Row::damping_ratio},
      {"mass_kg", "kg", "virtual mass; empty where it is not searched", &Row::mass},
      {"velocity_filter", "", "of the device, as JSON; empty: the scene's", &Row::filter},
      {"feasible", "", "true when every constraint is kept", &Row::feasible},
      {"binding", "",
       "the first constraint that is not: settled (at K), margin (up to G K), a limited metric, or runs, the bound on "
       "them",
       &Row::binding},
      {"why", "", "the same in words", &Row::why}};
  for (const char* name : {kTuneMetrics[0], kTuneMetrics[1], kTuneMetrics[2]}) {
    columns.add(
        {{name, name == kTuneMetrics[0] ? "m" : "N", "of the scene's own run at K; empty where it was not asked for",
          [name](const Row& r) { return value_in(r.metrics, name); }}});
  }
  return columns;
}

Json law_json(const TunedLaw& law) {
  Json json = tuned_columns().json(law);
  for (const Margin& margin : kMargins) json["margins"][margin.key] = cell_json(cell_of(law.margins.*margin.of));
  json["metrics"] = law.choice ? law.choice->metrics : TuneMetrics();
  json["error"] = law.error;
  json["linear_edge"] = law.choice ? cell_json(cell_of(law.edge.linear_edge())) : Json();
  json["edge_in_runs"] = law.choice ? cell_json(cell_of(law.edge.value)) : Json();
  return json;
}

Json limits_json(const TuneQuestion& question) {
  Json limits = {{"margin", question.margin}};
  for (const auto& [name, bound] : question.limits) {
    if (bound.min) limits[name]["min"] = *bound.min;
    if (bound.max) limits[name]["max"] = *bound.max;
  }
  return limits;
}

Json tuning_json(const Tuning& tuning, const fs::path& tuned) {
  Json laws = Json::array();
  for (const TunedLaw& law : tuning.laws) laws.push_back(law_json(law));
  const auto name_of = [&](std::size_t place) {
    return place < tuning.ranking.size() ? Json(tuning.ranking[place]->algorithm) : Json();
  };
  return {{"algorithms", std::move(laws)},
          {"recommended", name_of(0)},
          {"runner_up", name_of(1)},
          {"limits", limits_json(tuning.question)},
          {"scenario", tuned.empty() ? Json() : Json(tuned.string())},
          {"runs", tuning.runs}};
}

Json tuned_scenario(const Tuning& tuning, const TunedLaw& law, const fs::path& out) {
  const Scenario choice = load_scenario(tuning.question.scenario, law.overrides).scenario;
  Json json = effective_scenario(choice, out);
  json["name"] = tuning.question.scenario.file.stem().string() + "_tuned";
  json["description"] = fmt::format("{} tuned by hapbench tune: {}", choice.name, law.algorithm);
  return json;
}

std::string limits_text(const Tuning& tuning) {
  std::string text = fmt::format("largest K that is settled up to {:g} K{}", tuning.question.margin,
                                 tuning.ranges.damping_ratio ? ", with B = 2 zeta sqrt(K m) at each" : "");
  if (tuning.question.limits.empty())
    text += ", in a run that is quiet (describe diagnosis: buzz, pop, chatter, energy)";
  for (const auto& [name, bound] : tuning.question.limits) {
    if (bound.min) text += fmt::format(", {} >= {:g}", name, *bound.min);
    if (bound.max) text += fmt::format(", {} <= {:g}", name, *bound.max);
  }
  const auto range = [](const char* name, const std::optional<Range>& found) {
    return found ? fmt::format("; {} {:.3g} ... {:.3g}", name, found->from, found->to) : "";
  };
  return text + range("zeta", tuning.ranges.damping_ratio) + range("virtual mass [kg]", tuning.ranges.mass);
}

std::string choice_text(const TuneTrial& choice) {
  return fmt::format("K = {} N/m{}", stiffness_text(choice), setting_text(choice));
}

std::string margins_text(const TuneMargins& margins) {
  std::vector<std::string> texts;
  for (const Margin& margin : kMargins)
    if (const auto& found = margins.*margin.of)
      texts.push_back(
          fmt::format(fmt::runtime(margin.words), (*found >= margin.most ? "over " : "") + significant(*found, 3)));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string recommendation_text(const Tuning& tuning) {
  if (tuning.ranking.empty()) return "nothing is feasible\n";
  const TunedLaw* best = tuning.ranking[0];
  std::string text = bold(stdout, fmt::format("use {}, {}", best->algorithm, choice_text(*best->choice))) + "\n";
  const auto line = [&](const char* name, const std::string& what) { text += entry(name, what, 2, 14); };
  line("stops at", fmt::format("{}: {}", best->binding, best->why));
  line("margins", margins_text(best->margins));
  if (tuning.ranking.size() > 1) {
    const TunedLaw* next = tuning.ranking[1];
    line("runner-up",
         fmt::format("{}, {}: {} times the rendered stiffness", next->algorithm, choice_text(*next->choice),
                     significant(next->choice->rendered() / best->choice->rendered(), 2)));
  }
  line("K's edges", limit_answer(best->edge, kEdgeResolution));
  line("verified",
       fmt::format("by {} full-length runs between K and {:g} K, all settled: at most {:.0f} % of what lies "
                   "between may not be (95 %); {} runs in all",
                   best->verified, tuning.question.margin, 100.0 * may_fail_share(kTriedBetween), tuning.runs));
  line("expect", "+-: how far half the step, half the distance of the points or a look at every row move it");
  for (const auto& [name, value] : best->choice->metrics)
    line("", fmt::format("{} {}", name, with_error_text(value, value_in(best->error, name))));
  return text;
}

std::string tuning_text(const Tuning& tuning) {
  std::string text = wrapped(fmt::format("{}: {}", tuning.scene, limits_text(tuning)), 0) + "\n" +
                     recommendation_text(tuning) + "\n" + tuned_columns().table(tuning.laws).text() + "\n";
  for (const TunedLaw& law : tuning.laws)
    if (!law.choice)
      text += wrapped(fmt::format("{}: nothing is feasible, {}; {}", law.algorithm, law.why, law.relax), 0);
  return text;
}

std::string device_text(const std::string& name, TuneQuestion& question) {
  if (name.empty()) return "";
  const std::vector<ComparedDevice> devices = chosen_devices({name});
  if (devices.size() != 1)
    throw InputError(fmt::format("--device: got \"{}\"; allowed: one device, a preset or a file NAME.json", name));
  const ComparedDevice& device = devices.front();
  question.overrides = overrides_on(device, question.scenario, question.overrides);
  return " on " + device.name;
}

/// A range of numbers above 0, which are searched by their ratios; none for an empty text. Throws InputError.
std::optional<Range> ratios_of(const char* option, const std::string& text) {
  std::optional<Range> range = range_of(option, text);
  if (!range) return range;
  if (!(range->from > 0.0)) throw InputError(fmt::format("{}: got \"{}\"; allowed: a:b with 0 < a < b", option, text));
  range->logarithmic = true;
  return range;
}

TuneQuestion tune_question(const TuneOptions& options, const fs::path& file) {
  TuneQuestion question = options.question;
  question.scenario = read_scenario_text(file);
  question.overrides = options.overrides;
  if (!(question.margin > 1.0 && question.margin <= 16.0))
    throw InputError(fmt::format("--margin: got {}; allowed: more than 1, at most 16", question.margin));
  for (const std::string& bound : options.bounds) add_bound(bound, question.limits);
  if (!options.family.empty())
    question.families = chosen_names("--family: got", options.family, {std::begin(kFamilies), std::end(kFamilies)});
  if (const auto range = ratios_of("--damping-ratio", options.damping_ratio)) question.damping_ratio = *range;
  question.mass = ratios_of("--mass", options.mass);
  question.threads = job_options(options, "").threads;
  return question;
}

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

int tune(const TuneOptions& options) {
  const fs::path file = find_scenario(options.scenario);
  Tuning tuning;
  tuning.question = tune_question(options, file);
  const std::string device = device_text(options.device, tuning.question);
  const LoadedScenario loaded = checked(load_scenario(tuning.question.scenario, tuning.question.overrides));
  const std::vector<std::string> algorithms = options.algorithms.empty()
                                                  ? std::vector<std::string>{loaded.scenario.rendering.algorithm}
                                                  : chosen_algorithms(options.algorithms);
  print_warnings(loaded);
  tuning.scene = loaded.scenario.name + device;
  tuning.ranges = with_file(loaded, [&] { return tune_ranges(tuning.question, algorithms.front()); });
  Report report(options, "tune_" + file.stem().string());
  const fs::path& out = report.folder();
  tune_laws(algorithms, options.output.quiet, tuning);
  report.write("tune.csv", tuned_columns(), tuning.laws);
  std::vector<TuneTrial> trials;
  for (const TunedLaw& law : tuning.laws) trials.insert(trials.end(), law.trials.begin(), law.trials.end());
  report.write("tune_trials.csv", trial_columns(), trials);
  report.say(tuning_text(tuning));
  if (const std::string delay = delay_note(loaded.scenario); !delay.empty()) report.say(wrapped(delay, 0));
  fs::path tuned;
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

std::vector<DescribedTable> tune_tables() {
  return {
      tuned_columns().described("tune.csv", "of tune: one line per algorithm"),
      trial_columns().described("tune_trials.csv", "of tune: one line per algorithm, setting and K that was tried")};
}

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
      "For each law the largest K, over zeta (and virtual mass on an admittance device), at which the scene's own run and each of the "
      "family is settled (\"hapbench describe stability\"; where a script moves the tool, no more than 1 mm/s rms above 30 Hz at the handle) at K and at margin x K, the loop of "
      "device, hand and surface while they touch is stable as far by its eigenvalues, and all limits are kept at K; without limits of yours the own run is quiet, by the rules of "
      "\"hapbench describe diagnosis\": buzz, pop, chatter, energy. Hands are "
      "springs of 100 and 1000 N/m, on an impedance device's handle with 0.1 and 0.5 kg; the loop's, also none. Recommended is the law "
      "that settles least deep; on springs, the one that renders most stiffness. At most {} runs a law search. The choice is verified by {} runs of full length between K and margin x K, and by longer ones; it keeps your limits by as "
      "much as half the step, half the spacing and a look at the depth in every row move a number. "
      "Where nothing is feasible, it says which limit to relax. Files: tune.csv, tune_trials.csv, NAME_tuned.json, which run takes.",
      kMostTuneRuns, kTriedBetween + kTriedNear));
}

}  // namespace hapbench
