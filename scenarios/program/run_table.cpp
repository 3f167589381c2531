#include "scenarios/program/run_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "results/summary/summary.hpp"
#include "scenarios/batch/number_with_error.hpp"
#include "scenarios/input/rounding.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

/// Returns a number with few characters: "1440" instead of "1.44e+03", and never "-0".
std::string cell(std::optional<double> value, int digits = 3) {
  if (value && digits < 3) value = rounded_to_digits(*value, digits);
  if (value && std::abs(*value) >= 100.0 && std::abs(*value) < 1e6) return fmt::format("{:.0f}", *value);
  return value ? significant(*value + 0.0, digits) : "-";
}

/// Returns the member of Result that distinguishes the runs: the name of the algorithm if all runs are of one scenario,
/// else the name of the scenario.
std::string Result::*distinct_name(std::span<const Result> reports) {
  return reports.front().name == reports.back().name ? &Result::algorithm : &Result::name;
}

/// Returns the outcome of a run. Adds the time at which the run ended, if it ended early, or the time of the last
/// contact, if the tool lost contact. Adds no time of the last contact if the tool went through the surface, because
/// points inside the tool count as contact also behind the surface.
std::string ending_text(const Result& report) {
  const std::string name(outcome_name(report.end.outcome));
  const auto last = number_of(report.metrics, "last_contact_s");
  if (report.end.ended_at && report.end.outcome != Outcome::diverges)
    return fmt::format("{} at {:.3g} s", name, *report.end.ended_at);
  switch (report.end.outcome) {
    case Outcome::leaves_hole:
    case Outcome::tool_horizontal:
      // A run with the section "targets" has several trials, which end at different times.
      return !report.sections.contains("targets") ? fmt::format("{} at {:.3g} s", name, report.duration) : name;
    case Outcome::diverges:
      return fmt::format("{} at {:.3g} s", name, report.end.divergence.time);
    case Outcome::lost_contact:
      return last ? fmt::format("{}, last contact at {:.3g} s", name, *last) : name;
    default:
      return name;
  }
}

void add_metrics(Columns<Result>& columns, std::span<const RunHeading> headings) {
  add_metrics(columns, headings, [](const Result& run, const char* metric) {
    const Metric* found = find_metric(run.metrics, metric);
    return found == nullptr ? NumberWithError{} : NumberWithError{number_of(found->value), found->tolerance()};
  });
}

Columns<Result> run_columns(bool of_scenes) {
  const auto vibration = [](const Result& r) {
    const auto power = number_of(r.metrics, kToolVibrationPower);
    return power ? short_text(std::sqrt(*power), std::nullopt, 1e3) : "-";
  };
  const auto ratios = [](const Result& r) {
    const auto smallest = number_of(r.metrics, "ratio_min"), largest = number_of(r.metrics, "ratio_max");
    return smallest && largest ? fmt::format("{}..{}", cell(smallest, 2), cell(largest, 2)) : "-";
  };
  const auto step_time = [](const Result& r) { return short_text(r.timing.step_p50, std::nullopt, 1e6); };
  Columns<Result> columns = {
      {of_scenes ? "scenario" : "", "", "", &Result::name, only_printed()},
      {"algorithm", "", "", &Result::algorithm, only_printed()},
      {"outcome", "",
       "outcome of the run, with its time if the run ended before the last step; for lost_contact otherwise the time "
       "of the last contact",
       ending_text, only_printed()}};
  add_metrics(columns, kRunHeadings);
  columns.add(
      {{"tool vibration\n[mm/s rms]", "1",
        "root of vibration_power_above_30Hz_m2_per_s2: rms of the tool's velocity above 30 Hz, over all time steps",
        vibration, only_printed(of_scenes)},
       {"stiffness\nratio", "1", "ratio_min", ratios, only_printed(true)},
       {"median step\ntime [us]", "1", "step_p50_s", step_time, only_printed(true)}});
  return columns;
}

/// Columns that compare the rendered force with the reference force. The reference force is the field reference_force
/// of the scenario, or the force that was measured while the stroke was recorded.
constexpr RunHeading kFidelityHeadings[] = {
    {"force\nerror [%]", "fidelity.force_error_relative", 100.0, false},
    {"normal\n[N rms]", "fidelity.force_error_normal_rms_N", 1.0, false},
    {"tangential\n[N rms]", "fidelity.force_error_tangential_rms_N", 1.0, false},
    {"direction\n[deg]", "fidelity.force_direction_error_rad", 57.295779513082323, false},
    {"artefacts\n[%]", "fidelity.force_artefact_share", 100.0, false},
    {"lag\n[ms]", "fidelity.force_lag_s", 1e3, false}};

}  // namespace

std::string metric_unit(const std::string& metric) {
  const Metric* known = find_metric(all_metrics(), metric);
  return known == nullptr ? "1" : known->unit;
}

std::string short_text(std::optional<double> value, const std::optional<double>& tolerance, double factor) {
  if (!value) return "-";
  if (is_only_bounded({value, tolerance})) return bound_text(factor * *value, factor * *tolerance);
  return cell(factor * *value, deserved_digits(*value, tolerance, 3));
}

Table run_table(std::span<const Result> reports, bool of_scenes, const Layout& layout) {
  const std::string caption = of_scenes ? "runs" : fmt::format("runs of {}", reports.front().name);
  return run_columns(of_scenes).table(reports, caption, layout.in_full());
}

std::string headings_legend(bool has_empty_mean, bool has_depth, const Layout& layout) {
  std::string text =
      "mean force: mean of the rendered force in settled contact; vibration: rms of this force above 30 Hz";
  if (has_empty_mean) text += " (-: settled contact lasts less than 33 ms)";
  if (has_depth) text += "; max depth inside: largest depth of the tool below the surface";
  return layout.wrapped(text, 0);
}

std::string run_legend(std::span<const Result> reports, const Layout& layout) {
  const auto known = [](const char* metric) {
    return [metric](const Result& run) { return number_of(run.metrics, metric).has_value(); };
  };
  // A run that ended early has no metrics at all.
  const bool has_empty_mean = std::ranges::any_of(
      reports, [&](const Result& run) { return !run.end.ended_at && !known("force_mean_in_contact_N")(run); });
  return "\n" + headings_legend(has_empty_mean, std::ranges::any_of(reports, known("inside_max_m")), layout);
}

void report_fidelity(std::span<const Result> reports, const Layout& layout, Report& report) {
  std::vector<std::reference_wrapper<const Result>> with_reference;
  for (const Result& run : reports)
    if (run.sections.contains("fidelity")) with_reference.emplace_back(run);
  if (with_reference.empty()) return;
  const auto name = distinct_name(reports);
  Columns<Result> columns = {{name == &Result::algorithm ? "algorithm" : "scenario", "", "", name, only_printed()}};
  add_metrics(columns, kFidelityHeadings);
  const char* caption = "rendered force compared with the reference force (measured, or given by reference_force)";
  report.add_text(fmt::format("\n{}\n\n", caption));
  report.show(columns.table(with_reference, caption, layout.in_full()));
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the cases of merging share the list.
std::vector<std::string> run_warnings(std::span<const Result> reports) {
  /// A warning of one or more algorithms. `others`: number of further runs of the same algorithm whose warnings differ
  /// from `text` in their numbers.
  struct Merged {
    std::string kind, text;
    std::vector<std::string> algorithms;
    std::size_t others = 0;
  };
  std::vector<Merged> all;
  for (const Result& report : reports) {
    for (const Warning& warning : report.warnings) {
      if (!warning.pointer.empty()) continue;  // was printed before the run
      // Merge equal texts of several algorithms, and texts of one algorithm that differ in their numbers.
      const auto is_of_algorithm = [&](const Merged& known) {
        return known.kind == warning.kind && std::ranges::count(known.algorithms, report.algorithm) > 0;
      };
      const auto has_text = [&](const Merged& known) {
        return known.kind == warning.kind && known.text == warning.text;
      };
      if (const auto same = std::ranges::find_if(all, has_text); same != all.end()) {
        if (!is_of_algorithm(*same)) same->algorithms.push_back(report.algorithm);
      } else if (const auto own = std::ranges::find_if(all, is_of_algorithm); own != all.end()) {
        ++own->others;
      } else {
        all.push_back({warning.kind, warning.text, {report.algorithm}});
      }
    }
  }
  std::vector<std::string> texts;
  for (const Merged& warning : all) {
    const std::string laws =
        reports.size() > 1 ? fmt::format(", with {}", fmt::join(warning.algorithms, ", ")) : std::string();
    std::string text = fmt::format("{}{}: {}", reports.front().name, laws, warning.text);
    if (warning.others > 0) text += fmt::format(" (further runs with other numbers: {})", warning.others);
    texts.push_back(std::move(text));
  }
  return texts;
}

std::string step_time_text(std::span<const Result> reports, const Layout& layout) {
  // With --latency, a separate table has the percentiles of the step times. Use the same times here, because another
  // sample would give other percentiles.
  const bool has_table = reports.front().timing.latency.has_value();
  const auto p99 = [](const Result& report) {
    const auto& timed = report.timing.latency;
    return timed ? 1e-9 * static_cast<double>(timed->p99) : report.timing.step_p99.value_or(0.0);
  };
  const Result& slowest = *std::ranges::max_element(reports, {}, p99);
  if (p99(slowest) == 0.0) return "";
  const std::string whose = reports.size() == 1 ? "" : fmt::format(" ({})", slowest.*distinct_name(reports));
  const double step = slowest.duration / static_cast<double>(slowest.end.rows);
  std::string text =
      has_table ? fmt::format("the 99th percentile of the step times{} is", whose)
                : fmt::format("99 % of the time steps are computed within {} us{}", cell(1e6 * p99(slowest), 2), whose);
  if (p99(slowest) > step)
    text += fmt::format(
        "{} longer than the time step of {} us; try fewer points, rendering.reduction or a faster algorithm",
        has_table ? "" : ", which is", cell(1e6 * step, 2));
  else if (has_table)
    return "";
  return layout.wrapped(text, 0);
}

std::string value_and_threshold_text(const Diagnosed& found) {
  return fmt::format("{:.3g}, threshold {}", found.value, with_unit(found.threshold, found.unit));
}

std::string number_text(double value, const std::optional<double>& error) {
  if (error && *error == 0.0) return significant(value, 6);
  return error && *error >= std::abs(value) ? significant(value, 1) : deserved(value, error);
}

std::string with_error_text(double value, const std::optional<double>& error) {
  return number_text(value, error) + " +- " + (error ? significant(*error, 1) : "?");
}

std::vector<DescribedTable> run_tables() {
  Columns<Result> runs = run_columns(true);
  add_metrics(runs, kFidelityHeadings);
  return {runs.described()};
}

}  // namespace hapbench
