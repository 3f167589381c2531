#include "scenarios/program/work_precision.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/program/digits.hpp"

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
/// Returns an error in a thousandth of the unit; "<" marks an error that the reference solution does not resolve.
std::string error_text(const Setting& s, double error, double of_reference, double unit) {
  if (!s.error) return "-";
  const double shown = std::max(error, of_reference) / unit;
  return fmt::format("{}{}", error < kResolvedError * of_reference ? "< " : "", significant(shown, 2));
}

/// Returns the columns of convergence.csv, which are the same in every run of the command. `max_error` [m]: the
/// requested error.
Columns<Setting> error_columns(double max_error) {
  const auto reference_position = [](const Setting& s) { return s.reference_error.position; };
  const auto reference_force = [](const Setting& s) { return s.reference_error.force; };
  const auto micrometres = [](const Setting& s) {
    return error_text(s, s.error ? s.error->position : 0.0, s.reference_error.position, 1e-6);
  };
  const auto millinewtons = [](const Setting& s) {
    return error_text(s, s.error ? s.error->force : 0.0, s.reference_error.force, 1e-3);
  };
  const auto cost = [](const Setting& s) { return significant(1e3 * s.cost.per_simulated_second(), 3); };
  const auto share = [](const Setting& s) { return significant(100.0 * s.cost.deadline_share(), 2); };
  const auto mark = [](const Setting& s) { return s.is_knee ? "knee" : s.on_front ? "front" : ""; };
  return {
      {"problem", "", "values of the fields of --over that define the problem, such as the law", &Setting::problem},
      {"integrator", "", "integrator of the curve", &Setting::integrator, under("integrator")},
      {"step_s", "s", "time step", &Setting::step_s, varied(under("step\ns"))},
      {"position_error_m", "m",
       "rms distance of the tip's positions from the reference solution, at the times of the largest time step; empty "
       "if the trajectory cannot be predicted, or if one of the runs ended early",
       position_error},
      {"error um", "1", "position_error_m in micrometres; <: not resolved by the reference solution", micrometres,
       only_printed()},
      {"force_error_N", "N", "rms difference of the rendered forces from the reference solution at the same times",
       force_error},
      {"error mN", "1", "force_error_N in millinewtons; <: not resolved by the reference solution", millinewtons,
       only_printed()},
      {"reference_position_error_m", "m", "error of the reference solution's positions", reference_position},
      {"reference_force_error_N", "N", "error of the reference solution's forces", reference_force},
      {"resolved", "", "true if position_error_m is at least ten times reference_position_error_m",
       &Setting::is_resolved},
      {"asked_error_m", "m", "position error that is asked for (--to)",
       [max_error](const Setting&) { return max_error; }},
      {"ms/s", "1", "processor time per simulated second [ms]", cost, only_printed()},
      {"% of 0.5 ms", "1", "processor time of a step as a percentage of 0.5 ms", share, only_printed()},
      {"on front", "",
       "front: no other setting of the problem is both cheaper and more accurate; knee: bend of the front", mark,
       only_printed()}};
}

/// Returns the columns of convergence_timing.csv, which differ from run to run.
Columns<Setting> timing_columns() {
  const auto deadline = [](const Setting& s) { return s.cost.deadline_share(); };
  const auto simulated = [](const Setting& s) { return s.cost.per_simulated_second(); };
  const auto step = [](const Setting& s) { return s.cost.step_s; };
  const auto spread = [](const Setting& s) { return s.cost.spread_s; };
  return {{"problem", "", "problem of convergence.csv", &Setting::problem},
          {"integrator", "", "integrator of the curve", &Setting::integrator},
          {"step_s", "s", "time step", &Setting::step_s},
          {"seconds_per_step", "s", "processor time of a step in a run without observers: smallest of five repetitions",
           step},
          {"spread_s", "s", "median of the repetitions minus the smallest repetition", spread},
          {"seconds_per_simulated_second", "s/s", "processor time per simulated second", simulated},
          {"deadline_share", "1", "processor time of a step divided by 0.5 ms", deadline},
          {"on_front", "", "true if no other resolved setting of the problem is both cheaper and more accurate",
           &Setting::on_front},
          {"knee", "", "true for the knee of the front: the point farthest below the chord, in logarithms",
           &Setting::is_knee}};
}

/// Returns a sentence with the cheapest setting of a problem below `max_error` [m], or the reason why no setting is
/// named.
std::string answer_text(const WorkPrecisionProblem& problem, double max_error) {
  if (!problem.is_predictable) {
    return fmt::format(
        "no error is stated: an initial shift of 1 nm grows to {} m, which is more than the error asked for ({:g} m; "
        "--to changes it); compare metrics over seeds instead: hapbench compare --seeds 5 --jitter 1e-9",
        significant(problem.grown_shift, 2), max_error);
  }
  const WorkPrecisionSetting* best = problem.cheapest_below(max_error);
  if (best == nullptr)
    return fmt::format("no setting has an error below {:g} m; smaller time steps: more --levels", max_error);
  return fmt::format(
      "the cheapest setting below {:g} m is {} at {} s: {} ms per simulated second, {} % of the deadline", max_error,
      best->integrator, significant(best->step_s, 6), significant(1e3 * best->cost.per_simulated_second(), 2),
      significant(100.0 * best->cost.deadline_share(), 2));
}

}  // namespace

void report_work_precision(const std::vector<WorkPrecisionProblem>& problems, double max_error, const Layout& layout,
                           Report& report) {
  std::vector<Setting> all;
  for (const WorkPrecisionProblem& problem : problems) {
    all.insert(all.end(), problem.settings.begin(), problem.settings.end());
    report.say(problem.name + "\n\n");
    report.show(error_columns(max_error).table(problem.settings, problem.name, layout.in_full()));
    report.say("\n" + layout.wrapped(answer_text(problem, max_error), 0));
    const auto& first = problem.settings.front();
    report.say(layout.wrapped(fmt::format("reference: {}; its error is about {} m and {} N", problem.reference,
                                          significant(first.reference_error.position, 1),
                                          significant(first.reference_error.force, 1)),
                              0) +
               "\n");
    Json json = {{"problem", problem.name}, {"predictable", problem.is_predictable}, {"reference", problem.reference}};
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

std::vector<DescribedTable> work_precision_tables() {
  return {error_columns(0.0).described(kErrors,
                                       "written by converge --over: one line per problem, integrator and time step"),
          timing_columns().described(
              kTimes,
              "written by converge --over: cost of each setting (in a file of its own because it differs from "
              "run to run)")};
}

}  // namespace hapbench
