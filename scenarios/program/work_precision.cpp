#include "scenarios/program/work_precision.hpp"

#include <fmt/format.h>

#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <numbers>

#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/run/bare_run.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

using Setting = WorkPrecisionSetting;

constexpr const char *kErrors = "convergence.csv", *kTimes = "convergence_timing.csv";

std::optional<double> position_error(const Setting& s) {
  return s.error ? std::optional(s.error->position) : std::nullopt;
}
std::optional<double> force_error(const Setting& s) {
  return s.error ? std::optional(s.error->force) : std::nullopt;
}

/// Returns true if the reference solution, which has the error `of_reference`, is too inexact to determine `error`.
bool is_unresolved(double error, double of_reference) {
  return error < kResolvedError * of_reference;
}

/// Returns an error of a setting as text, in multiples of `unit`. `difference`: difference of the setting from the
/// reference solution. `of_reference`: error of the reference solution. If is_unresolved(), the text is "<" and the
/// largest possible error, the sum of both.
std::string error_text(double difference, double of_reference, double unit) {
  if (!is_unresolved(difference, of_reference)) return significant(difference / unit, 2);
  return "< " + significant_up((difference + of_reference) / unit, 2);
}

/// Returns true if the table marks an error of the setting with "<".
bool has_unresolved_error(const Setting& s) {
  return s.error && (is_unresolved(s.error->position, s.reference_error->position) ||
                     is_unresolved(s.error->force, s.reference_error->force));
}

/// Returns the columns of convergence.csv. Their values are the same if the command is repeated. `max_error` [m]: the
/// requested error.
Columns<Setting> error_columns(double max_error) {
  const auto reference_position = [](const Setting& s) {
    return s.reference_error ? std::optional(s.reference_error->position) : std::nullopt;
  };
  const auto reference_force = [](const Setting& s) {
    return s.reference_error ? std::optional(s.reference_error->force) : std::nullopt;
  };
  const auto micrometres = [](const Setting& s) {
    return s.error ? error_text(s.error->position, s.reference_error->position, 1e-6) : "-";
  };
  const auto millinewtons = [](const Setting& s) {
    return s.error ? error_text(s.error->force, s.reference_error->force, 1e-3) : "-";
  };
  const auto cost = [](const Setting& s) { return significant(1e3 * s.cost.per_simulated_second(), 3); };
  const auto share = [](const Setting& s) { return significant(100.0 * s.cost.per_simulated_second(), 2); };
  const auto mark = [](const Setting& s) { return s.is_knee ? "knee" : s.on_front ? "front" : ""; };
  return {
      {"problem", "", "values of the fields of --over that define the problem, such as the law", &Setting::problem},
      {"integrator", "", "integrator of the curve", &Setting::integrator, under("integrator")},
      {"step_s", "s", "time step", &Setting::step_s, varied(under("step\ns"))},
      {"outcome", "", "outcome of the run", [](const Setting& s) { return outcome_name(s.outcome); }},
      {"expected", "",
       "true if the scenario expects the outcome; other settings are not on the front and are not recommended",
       &Setting::is_expected},
      {"position_error_m", "m",
       "rms distance of the tip's positions from the reference solution, at the times of the largest time step; empty "
       "if the trajectory cannot be predicted, or if one of the runs ended early",
       position_error},
      {"error um", "1",
       "position_error_m in micrometres; <: not resolved by the reference solution, largest possible error",
       micrometres, only_printed()},
      {"force_error_N", "N", "rms difference of the rendered forces from the reference solution at the same times",
       force_error},
      {"error mN", "1",
       "force_error_N in millinewtons; <: not resolved by the reference solution, largest possible error", millinewtons,
       only_printed()},
      {"reference_position_error_m", "m", "error of the reference solution's positions", reference_position},
      {"reference_force_error_N", "N", "error of the reference solution's forces", reference_force},
      {"resolved", "", "true if position_error_m is at least ten times reference_position_error_m",
       &Setting::is_resolved},
      {"asked_error_m", "m", "requested position error (--to)", [max_error](const Setting&) { return max_error; }},
      {"ms/s", "1", "processor time per simulated second [ms]", cost, only_printed()},
      {"% of\nstep", "1", "processor time of a step as a percentage of the time step, its deadline in real time", share,
       only_printed()},
      {"on front", "",
       "front: the error is resolved, and no other setting of the problem is both cheaper and more accurate; knee: "
       "bend of the front",
       mark, only_printed()}};
}

/// Returns the columns of convergence_timing.csv. Their values are times, which differ if the command is repeated.
Columns<Setting> timing_columns() {
  const auto simulated = [](const Setting& s) { return s.cost.per_simulated_second(); };
  const auto step = [](const Setting& s) { return s.cost.step_s; };
  const auto spread = [](const Setting& s) { return s.cost.spread_s; };
  return {
      {"problem", "", "problem of convergence.csv", &Setting::problem},
      {"integrator", "", "integrator of the curve", &Setting::integrator},
      {"step_s", "s", "time step", &Setting::step_s},
      {"seconds_per_step", "s", "processor time of a step in a run without observers: smallest of five repetitions",
       step},
      {"spread_s", "s", "median of the repetitions minus the smallest repetition", spread},
      {"seconds_per_simulated_second", "s/s", "processor time per simulated second", simulated},
      {"deadline_share", "1", "processor time of a step divided by the time step, its deadline in real time",
       simulated},
      {"on_front", "",
       "true if the outcome is expected, the error is resolved, and no other setting of the problem is both cheaper "
       "and more accurate; an error that is not resolved counts as its bound",
       &Setting::on_front},
      {"knee", "", "true for the knee of the front: the point farthest below the chord, in logarithms",
       &Setting::is_knee}};
}

/// Returns a setting as text, such as "rk4 at 0.001 s".
std::string name_of(const Setting& setting) {
  return fmt::format("{} at {} s", setting.integrator, significant(setting.step_s, 6));
}

/// Returns a sentence for a problem without a setting whose error is at most `max_error` [m] for certain.
std::string none_below_text(const WorkPrecisionProblem& problem, double max_error) {
  constexpr const char* kSmaller = "--levels with a larger number adds smaller time steps";
  if (problem.cheapest_possibly_below(max_error) != nullptr)
    return fmt::format(
        "no setting is shown to be below {:g} m, because the reference is known to {} m only; {}, also for "
        "the reference",
        max_error, significant_up(problem.settings.front().reference_error->position, 3), kSmaller);
  const bool all_known = std::ranges::all_of(problem.settings, [](const Setting& s) { return s.error.has_value(); });
  return fmt::format("no setting {} an error below {:g} m{}; {}", all_known ? "has" : "is shown to have", max_error,
                     all_known ? "" : ": \"-\" marks settings without an error, because runs ended differently",
                     kSmaller);
}

/// Returns a sentence with the cheapest setting of a problem whose position error is below `max_error` [m], or the
/// reason why no setting is named.
std::string answer_text(const WorkPrecisionProblem& problem, double max_error) {
  if (!problem.noise.empty())
    return fmt::format("no error is stated: {}; without this noise, errors can be stated", problem.noise);
  if (!problem.is_predictable) {
    return fmt::format(
        "no error is stated: an initial shift of 1 nm grows to {} m, which is more than the requested error ({:g} m; "
        "--to changes it); compare metrics over seeds instead: hapbench compare SCENARIO --seeds 5 --jitter 1e-9",
        significant(problem.grown_shift, 2), max_error);
  }
  const WorkPrecisionSetting* best = problem.cheapest_below(max_error);
  const auto failed = std::ranges::find(problem.settings, false, &Setting::is_expected);
  if (best == nullptr && failed != problem.settings.end())
    return fmt::format(
        "no setting is recommended: with {} the run ends as {}, which the scene does not expect; the error of "
        "a failed run is not meaningful, for example if the tool does not move",
        name_of(*failed), outcome_name(failed->outcome));
  if (best == nullptr) return none_below_text(problem, max_error);
  const std::string cost = fmt::format("{} ms per simulated second, {} % of the time step, which is the deadline",
                                       significant(1e3 * best->cost.per_simulated_second(), 2),
                                       significant(100.0 * best->cost.per_simulated_second(), 2));
  const Setting* cheaper = problem.cheapest_possibly_below(max_error);
  if (cheaper == best)
    return fmt::format("the cheapest setting below {:g} m is {}: {}", max_error, name_of(*best), cost);
  return fmt::format(
      "the cheapest setting that is shown to be below {:g} m is {}: {}; {} is cheaper and may also be below, but its "
      "error is only known to be at most {} m",
      max_error, name_of(*best), cost, name_of(*cheaper), significant_up(cheaper->largest_error(), 3));
}

}  // namespace

void report_work_precision(const std::vector<WorkPrecisionProblem>& problems, double max_error, const Layout& layout,
                           Report& report) {
  std::vector<Setting> all;
  for (const WorkPrecisionProblem& problem : problems) {
    all.insert(all.end(), problem.settings.begin(), problem.settings.end());
    report.add_text(problem.name + "\n\n");
    report.show(error_columns(max_error).table(problem.settings, problem.name, layout.in_full()));
    report.add_text("\n");
    if (std::ranges::any_of(problem.settings, has_unresolved_error))
      report.add_text(layout.wrapped(
          fmt::format(
              "<: the difference from the reference solution is less than {:g} times the error of the reference "
              "solution; the printed bound is the sum of both",
              kResolvedError),
          0));
    report.add_text(layout.wrapped(answer_text(problem, max_error), 0));
    const auto& first = problem.settings.front();
    if (problem.is_predictable) {
      const std::string error = first.reference_error ? fmt::format("its error is about {} m and {} N",
                                                                    significant(first.reference_error->position, 1),
                                                                    significant(first.reference_error->force, 1))
                                                      : "its error is not known, because its runs ended differently";
      report.add_text(layout.wrapped(fmt::format("reference: {}; {}", problem.reference, error), 0));
    }
    report.add_text("\n");
    Json json = {{"problem", problem.name},
                 {"predictable", problem.is_predictable},
                 {"noise", problem.noise},
                 {"reference", problem.reference}};
    json["settings"] = Json::array();
    for (const Setting& setting : problem.settings) {
      Json& row = json["settings"].emplace_back(error_columns(max_error).json(setting));
      row.update(timing_columns().json(setting));
    }
    report.json().push_back(std::move(json));
  }
  report.write(kErrors, error_columns(max_error), all);
  report.write(kTimes, timing_columns(), all);
}

namespace {

constexpr const char *kModelErrors = "convergence_model.csv", *kModelTimes = "convergence_model_timing.csv";

/// Errors and step times of one case (a law, and the values of the other varied fields) in a scene with a reference
/// force.
struct ModelError {
  std::string problem;  ///< values of the fields of --over
  std::string outcome;
  bool is_expected = true;  ///< true if the scenario expects the outcome; if false, the optional errors below are empty
  std::optional<double> direction = {}, force = {}, relative = {}, displacement = {};  ///< [rad], [N], [1], [m]
  double reference_error = 0.0;  ///< error of the reference force [N]
  /// True if the law uses the same constraints as the computed reference force. The errors of such a law have no
  /// meaning.
  bool shares_reference = false;
  StepLatency steps = {};  ///< times of the steps in the fastest repetition
};

double seconds(std::uint64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

Columns<ModelError> model_columns() {
  using Row = ModelError;
  const auto degrees = [](const Row& r) {
    return r.direction ? significant(*r.direction * 180.0 / std::numbers::pi, 3) : "-";
  };
  const auto millimetres = [](const Row& r) { return r.displacement ? significant(*r.displacement * 1e3, 3) : "-"; };
  const auto microseconds = [](std::uint64_t nanoseconds) { return significant(1e6 * seconds(nanoseconds), 3); };
  const auto share = [](const Row& r) { return significant(100.0 * seconds(r.steps.p99_9) / kStepDeadlines[0], 2); };
  return {
      {"problem", "", "values of the fields of --over, such as the law", &Row::problem, under("problem")},
      {"outcome", "", "outcome of the run", &Row::outcome},
      {"expected", "", "true if the scenario expects the outcome; the errors of other runs are empty",
       &Row::is_expected},
      {"force_direction_error_rad", "rad",
       "mean angle between rendered force and reference force, where both exceed 0.1 N", &Row::direction},
      {"direction\ndeg", "1", "force_direction_error_rad in degrees", degrees, only_printed()},
      {"force_error_rms_N", "N", "root mean square of the rendered force minus the reference force", &Row::force,
       under("force error\nN rms", 3)},
      {"force_error_relative", "1", "force_error_rms_N / rms of the reference force", &Row::relative},
      {"displacement_rms_m", "m",
       "root mean square of the distance between the tip and a rigid tool's tip in the same hand; empty if the path is "
       "prescribed",
       &Row::displacement},
      {"displacement\nmm rms", "1", "displacement_rms_m in millimetres", millimetres, only_printed()},
      {"reference_error_N", "N", "error of the reference force; 0 if it is given or measured", &Row::reference_error},
      {"shares_reference", "",
       "true if the law renders by the constraints of the reference force, so that its error is not meaningful",
       &Row::shares_reference},
      {"median us", "1", "median time of a step in microseconds",
       [microseconds](const Row& r) { return microseconds(r.steps.p50); }, only_printed()},
      {"99.9 % us", "1", "99.9th percentile of the time of a step in microseconds",
       [microseconds](const Row& r) { return microseconds(r.steps.p99_9); }, only_printed()},
      {"99.9 % of\n0.5 ms [%]", "1", "99.9th percentile as a percentage of 0.5 ms", share, only_printed()}};
}

Columns<ModelError> model_timing_columns() {
  using Row = ModelError;
  return {{"problem", "", "problem of convergence_model.csv", &Row::problem},
          {"step_median_s", "s", "median time of a step in a run without observers: smallest of five repetitions",
           [](const Row& r) { return seconds(r.steps.p50); }},
          {"step_p99_9_s", "s", "99.9th percentile of the time of a step: smallest of five repetitions",
           [](const Row& r) { return seconds(r.steps.p99_9); }},
          {"deadline_s", "s", "time that a step may take", [](const Row&) { return kStepDeadlines[0]; }},
          {"deadline_share", "1", "step_p99_9_s / deadline_s",
           [](const Row& r) { return seconds(r.steps.p99_9) / kStepDeadlines[0]; }}};
}

/// Runs a case and returns its errors. Does not set the times of the steps.
ModelError model_error(const CheckedScenario& scene, std::string problem) {
  const Result run = run_scenario(scene, std::nullopt, false);
  const bool is_expected = outcome_is_expected(scene.scenario().expect, run.end.outcome);
  const auto metric = [&](const char* name) {
    return is_expected ? number_of(run.metrics, name) : std::optional<double>();
  };
  const bool is_rigid = std::holds_alternative<RigidContactFields>(*scene.scenario().reference_force);
  ModelError error{.problem = std::move(problem),
                   .outcome = std::string(outcome_name(run.end.outcome)),
                   .is_expected = is_expected,
                   .direction = metric("fidelity.force_direction_error_rad"),
                   .force = metric("fidelity.force_error_rms_N"),
                   .relative = metric("fidelity.force_error_relative"),
                   .displacement = metric("fidelity.displacement_rms_m"),
                   .shares_reference = is_rigid && run.algorithm == kSharesReference};
  if (run.sections["fidelity"].contains("reference_error_N"))
    error.reference_error = run.sections["fidelity"]["reference_error_N"].get<double>();
  return error;
}

}  // namespace

void report_model_errors(const Cases& cases, const JobOptions& jobs, const Layout& layout, Report& report) {
  std::vector<ModelError> all(cases.size());
  std::vector<std::unique_ptr<BareRun>> bare(cases.size());
  JobOptions one_by_one = jobs;
  one_by_one.threads = 1;
  // The first round computes the errors. Every further round times each case once. The first timing round warms the
  // caches.
  for_each_job(cases.size() * (kTimingRepetitions + 2), one_by_one, [&](std::size_t job) {
    const std::size_t i = job % cases.size(), round = job / cases.size();
    if (round == 0) {
      const CheckedScenario scene = checked(cases.load(i));
      all[i] = model_error(scene, fmt::format("{}", fmt::join(cases.values(i), ", ")));
      bare[i] = std::make_unique<BareRun>(scene, make_shell(scene.scenario(), scene.files()));
      return;
    }
    StepLatency latency = bare[i]->latency();
    StepLatency& smallest = all[i].steps;
    if (round == 1) return;
    if (round > 2) {
      latency.p50 = std::min(latency.p50, smallest.p50);
      latency.p99_9 = std::min(latency.p99_9, smallest.p99_9);
    }
    smallest = std::move(latency);
  });
  const auto error = [](const ModelError& e) { return e.force.value_or(std::numeric_limits<double>::infinity()); };
  std::ranges::stable_sort(all, {}, error);
  report.add_text("force compared with the reference force, and the time of a step\n\n" +
                  model_columns().text(all, layout));
  if (std::ranges::count(all, true, &ModelError::shares_reference) > 0)
    report.add_text(
        layout.wrapped(fmt::format("{}: renders by the constraints of the reference force; its error is not meaningful",
                                   kSharesReference),
                       0));
  for (const ModelError& row : all)
    if (!row.is_expected)
      report.add_text(
          layout.wrapped(fmt::format("{}: the run ends as {}, which the scene does not expect; no error is stated",
                                     row.problem, row.outcome),
                         0));
  report.json() = Json::array();
  for (const ModelError& row : all) {
    report.json().push_back(model_columns().json(row));
    report.json().back().update(model_timing_columns().json(row));
  }
  report.write(kModelErrors, model_columns(), all);
  report.write(kModelTimes, model_timing_columns(), all);
}

std::vector<DescribedTable> work_precision_tables() {
  return {model_columns().described(kModelErrors,
                                    "written by converge --over for a scene with a reference force: one line per law"),
          model_timing_columns().described(
              kModelTimes, "written by converge --over for a scene with a reference force: time of a step"),
          error_columns(0.0).described(kErrors,
                                       "written by converge --over: one line per problem, integrator and time step"),
          timing_columns().described(
              kTimes,
              "written by converge --over: cost of each setting (in a file of its own because it differs from "
              "run to run)")};
}

}  // namespace hapbench
