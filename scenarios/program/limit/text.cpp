#include "scenarios/program/limit/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/limit/columns.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/run/scripted_motion.hpp"

namespace hapbench {
namespace {

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K M) with damping_ratio zeta = {} and rendering.mass_kg M = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

/// Returns the resolution of the bisection.
std::string resolution_text(const LimitQuestion& question) {
  const IntervalSearchOptions& search = question.search;
  if (search.whole) return "1";
  return fmt::format("{} %{}", significant(100.0 * search.resolution), search.range.logarithmic ? "" : " of the range");
}

/// Returns the number of steps of a run, and the number of trials if a run has several.
std::string run_length_text(const Scenario& scenario) {
  const double trials = trial_count(scenario.hand);
  if (trials == 1.0) return fmt::format("{} steps", scenario.time.steps);
  return fmt::format("{:.0f} trials, all of which must be stable, of up to {} steps", trials, scenario.time.steps);
}

/// States the question for one scene. `over`: true if other fields vary too; values that depend on these fields are
/// then omitted.
std::string question_text(const LimitQuestion& question, const Scenario& scenario, bool over, const Layout& layout) {
  const IntervalSearchOptions& search = question.search;
  const std::string width = resolution_text(question);
  const auto end = [&search](double value) { return rounded_text(search.whole ? std::round(value) : value, 4); };
  std::string text = fmt::format("{}: {} stable {}, searched between {} and {} with a resolution of {}", scenario.name,
                                 question.side(), question.path, end(search.range.from), end(search.range.to), width);
  if (!over) text += "; runs of " + run_length_text(scenario);
  if (!over && question.path != "time.step_s") text += fmt::format(" of {} s", significant(scenario.time.step));
  if (!over && question.path == kStiffnessPath) text += "; " + damping_text(scenario.rendering);
  return layout.wrapped(text, 0);
}

/// States that no value is stable, with the number of runs in each class.
std::string none_text(const FieldLimit& limit) {
  std::map<RunVerdict, std::size_t> counts;
  for (const JudgedValue& run : limit.runs) ++counts[run.verdict];
  std::vector<std::string> texts;
  for (const auto& [verdict, count] : counts) texts.push_back(fmt::format("{} {}", count, run_verdict_name(verdict)));
  const std::string runs = fmt::format("of {} evaluated values", limit.runs.size());
  if (!limit.scattered) return fmt::format("none {} is stable: {}", runs, fmt::join(texts, ", "));
  return fmt::format(
      "no limit, because stable and unstable values alternate and no interval of {:g} % is stable; {}: {}",
      100.0 * kNearLimit, runs, fmt::join(texts, ", "));
}

/// Returns remarks on the answer of one row; may be empty.
std::string remarks_text(const LimitRow& row, const Layout& layout) {
  const FieldLimit& limit = row.limit;
  const LimitQuestion& question = row.question;
  std::string text;
  const auto say = [&](const std::string& what) { text += layout.wrapped(row.algorithm() + ": " + what, 0); };
  if (limit.end.value && limit.own && !question.rule.holds(limit.own->verdict)) {
    say(fmt::format(
        "the run at the scenario's value {} is not stable ({}): the limit is the end of the first stable interval, "
        "counted from the {} end of the range",
        significant(limit.own->value), run_verdict_name(limit.own->verdict),
        question.search.smallest ? "high" : "low"));
  }
  if (limit.scattered_at_current && limit.end.value && limit.own) {
    say(fmt::format(
        "the run at the scenario's value {} is stable, but around it stable and unstable values alternate and no "
        "interval of {:g} % is stable: the limit is the end of the first longer interval, counted from the {} end of "
        "the range",
        significant(limit.own->value), 100.0 * kNearLimit, question.search.smallest ? "high" : "low"));
  }
  if (limit.theory_has_none)
    say(fmt::format("by the eigenvalues of one step, no value of the range is stable{}",
                    limit.end.value ? "; the runs are too short to show the growth" : ""));
  if (limit.undecided > 0)
    say(fmt::format("{} runs were too short to distinguish slow motion from rest, even when extended up to 64 times",
                    limit.undecided));
  for (const auto& [metric, error] : limit.metric_errors)
    say(fmt::format(
        "{} has an error of {} at the limit, estimated with half the time step and half the point spacing; {}", metric,
        significant(error, 2),
        limit.violates_with_errors ? "a bound is violated with such an error added"
                                   : "its bound holds with this error added"));
  if (!limit.has_effect)
    say(fmt::format("{} has no effect here: the handle moves identically in all {} runs", question.path,
                    limit.runs.size()));
  if (limit.unstable_alone)
    say(fmt::format(
        "at {}, {} would be unstable even without contact: neither the contact nor its stiffness is the cause",
        significant((limit.end.beyond ? *limit.end.beyond : limit.runs.front()).value), limit.unstable_part));
  return text;
}

/// Returns a line for each reason why rows of a grid have no limit to quote, with the number of such rows.
std::string missing_quotes_text(const LimitTable& table, const Layout& layout) {
  constexpr std::size_t kMaxReasons = 4;
  std::vector<std::pair<std::string, std::size_t>> reasons;  // in the order of the rows
  for (const LimitRow& row : table.rows) {
    if (row.limit.quoted.value) continue;
    const auto known =
        std::ranges::find(reasons, row.limit.quoted.reason, [](const auto& entry) { return entry.first; });
    if (known == reasons.end())
      reasons.emplace_back(row.limit.quoted.reason, 1);
    else
      ++known->second;
  }
  std::vector<std::string> lines;
  for (const auto& [reason, rows] : reasons)
    lines.push_back(fmt::format("no quote in {} row{}: {}", rows, rows == 1 ? "" : "s", reason));
  std::string text;
  for (const std::string& line : first_few(lines, kMaxReasons)) text += layout.wrapped(line, 0);
  return text;
}

/// Returns true if the runs of the row are stable to the end of the range, vibrating runs count as stable, and the
/// device limits the force, so that no run can diverge.
bool is_unbounded_by_force_limit(const LimitRow& row) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&row.scenario.device);
  const bool is_limited = device != nullptr && device->force_max.has_value();
  return is_limited && !row.limit.end.beyond && row.limit.end.value && row.question.rule.bounded;
}

/// Returns the sentence on touch and hand that a limit with dry friction depends on; empty if no run is at a limit.
std::string touch_text(const LimitTable& table) {
  if (table.is_grid())
    return " Columns touch_speed_m_per_s and hand_force_max_N of limit.csv state both for the run at each limit.";
  const FieldLimit& limit = table.first().limit;
  if (!limit.end.value || !limit.settled.touch_speed) return "";
  return fmt::format(" In the run at {}, the handle touches at {} mm/s and the hand pushes with at most {} N.",
                     rounded_text(*limit.end.value, 6), significant(1e3 * *limit.settled.touch_speed),
                     significant(limit.settled.hand_force_max));
}

/// Returns notes that explain the table's columns and marks.
std::string notes_text(const LimitTable& table, const Layout& layout) {
  std::optional<double> friction;  // largest Coulomb friction over the handles [N]; empty without impedance devices
  for (const LimitRow& row : table.rows)
    if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&row.scenario.device))
      friction = std::max(friction, std::optional(device->coulomb));
  const auto is_published = [](const ComparedDevice& device) { return device.published_stiffness.has_value(); };
  std::string names;
  for (const ComparedDevice& device : table.devices) names += device.name + " ";
  const auto is_marked = [&names](const char* mark) { return names.find(mark) != std::string::npos; };
  const std::pair<bool, std::string> notes[] = {
      {table.is_grid(),
       "quote: the smaller of the linear and the simulated limit (with --smallest the larger); -: no limit, because no "
       "value is stable or the values are stable to the end of the range. Column quoted_reason of limit.csv has the "
       "reason"},
      {table.is_grid() && table.first().question.path == kStiffnessPath,
       "a quote has no margin: \"hapbench tune\" recommends a stiffness with a margin"},
      {!table.is_grid(), fmt::format("stable {}: other end of the interval of stable values that contains the limit",
                                     table.first().question.search.smallest ? "to" : "from")},
      {table.is_grid(),
       "linear limit: limit by the eigenvalues of the loop of device, hand and contact, without dry friction, encoder "
       "and force stage. \"no end\": the loop is stable to the end of the range; \"none stable\": it is stable at no "
       "value; \"-\": there is no linear limit (column no_linear_reason of limit.csv has the reason)"},
      {true,
       fmt::format(
           "first unstable: class of the first unstable run beyond the simulated limit ({}); if no value is stable, "
           "of the run at the low end of the range",
           table.first().question.rule.max_vibration ? "by the criterion above" : "\"hapbench describe stability\"")},
      {std::ranges::any_of(table.rows, is_unbounded_by_force_limit),
       "end of the range: device.force_max_N limits the force, so that an unstable loop vibrates without growing, "
       "which counts as stable here; --stable settled counts it as unstable"},
      {true,
       "non-monotonic: number of unstable runs on the stable side of the limit and of stable runs beyond it; "
       "if it is not 0, the simulated limit depends on the values that were tried. limit_runs.csv has the class of "
       "each run"},
      {table.is_grid(),
       "these limits were not verified by further runs. For verified limits, write the device into the field device of "
       "a scenario, and run \"hapbench limit\" with this scenario and one algorithm, without --device and --over"},
      {std::ranges::any_of(table.devices, is_published),
       "published: largest stable stiffness of a wall [N/m] that was published (\"hapbench describe DEVICE\" names the "
       "source)"},
      {is_marked("* "), "*: a preset with fields changed by --set; nothing is published for this combination"},
      {is_marked("[soft]"),
       fmt::format(
           "[soft], [stiff]: the preset with all unpublished parameters at one end of their ranges: [soft] with the "
           "smallest mass and friction and the coarsest encoder, [stiff] with the opposite ({})",
           kPresetRanges)},
      {is_marked("[friction*"), "[friction*2]: the preset with its dry friction multiplied by this factor"},
      {table.first().question.path == kStiffnessPath && friction.has_value(),
       "device_model/STABILITY.md, \"Which K to quote\", explains which of these stiffnesses to quote"},
      {friction > 0.0,
       "dry friction can hold the tool if the hand presses slowly. The limit then depends on the handle's speed at the "
       "touch and on the force of the hand, and is no property of the device." +
           touch_text(table) +
           " --set device.coulomb_N=0 gives the limit without dry friction. The dry friction of every preset is our "
           "estimate"}};
  std::string text;
  for (const auto& [holds, note] : notes)
    if (holds) text += layout.wrapped(note, 0);
  // State why a row has no limit to quote.
  if (table.is_grid()) text += missing_quotes_text(table, layout);
  // Add a note on each distinct delay of a device.
  std::vector<std::string> delays = {""};
  if (table.over() == 0)
    for (const LimitRow& row : table.rows) append_new(delays, {delay_note(row.scenario)});
  for (const std::string& delay : std::span(delays).subspan(1)) text += layout.wrapped(delay, 0);
  return text;
}

}  // namespace

std::string rule_text(const StabilityRule& rule, const Scenario& scenario) {
  std::string text =
      rule.max_vibration
          ? fmt::format(
                "criterion: a run is stable if the handle vibrates by at most {} m/s rms above {:.0f} Hz after the "
                "first quarter of the contact time, and bounces with a period above 1/{:.0f} s stop or become lower",
                *rule.max_vibration, kVibrationCutoff, kVibrationCutoff)
          : fmt::format(
                "criterion: a run is stable if it comes to rest or its oscillation decays by a tenth in each "
                "quarter of the run{}",
                rule.bounded ? ", or if it vibrates without growing" : "");
  for (const auto& [metric, bound] : rule.bounds) {
    if (bound.min) text += fmt::format(", and {} >= {}", metric, *bound.min);
    if (bound.max) text += fmt::format(", and {} <= {}", metric, *bound.max);
  }
  if (!rule.max_vibration && has_scripted_motion(scenario))
    text +=
        ". Because a script moves the tool, only motion above 30 Hz and faster than 1 mm/s counts. If the script ends "
        "in the first half of the run, all motion faster than 1 mm/s after the end of the script counts too";
  return text;
}

std::string limit_answer(const FieldLimit& found, const LimitQuestion& question) {
  if (!found.end.value) return none_text(found);
  const auto shown = [&](double value, const std::optional<double>& tolerance, int digits) {
    return deserved_on_side(value, printed_tolerance(question, tolerance), digits, stable_side(question));
  };
  const QuotedLimit& quoted = found.quoted;
  std::string text = quoted.value ? fmt::format("the limit to quote is {}, the {}",
                                                shown(*quoted.value, found.quoted_tolerance(), 6), quoted.reason)
                                  : fmt::format("no limit to quote: {}", quoted.reason);
  const auto& linear = found.known_linear_limit();
  // Name the limits that are not the quoted limit.
  if (linear && std::isfinite(*linear) && *linear > 0.0 && linear != quoted.value)
    text += fmt::format(". Linear limit {}", shown(*linear, std::nullopt, 6));
  if (found.end.beyond && found.end.value != quoted.value)
    text += fmt::format(". Simulated limit {}", shown(*found.end.value, found.end.tolerance(), 6));
  if (found.tried_all) return text + ". All values of the stable interval were run and are stable";
  if (found.tried_between == 0) return text;
  return text + fmt::format(
                    ". {} verification samples inside the stable interval are also stable: at most {:.0f} % of "
                    "the interval may be unstable (95 % confidence)",
                    found.tried_between, 100.0 * may_fail_share(found.tried_between));
}

void report_limits_text(const LimitTable& table, const Columns<LimitRow>& columns, const Layout& layout,
                        Report& report) {
  std::string text, answers, remarks;
  for (std::size_t i = 0; i < table.columns(); ++i) {
    const LimitRow& row = table.rows[i];
    if (i == 0 || row.scene() != table.rows[i - 1].scene())
      text += question_text(row.question, row.scenario, table.over() > 0, layout);
    if (table.is_grid()) continue;
    answers += layout.wrapped(fmt::format("{}: {}", row.algorithm(), limit_answer(row.limit, row.question)), 0);
    remarks += remarks_text(row, layout);
  }
  const LimitRow& first = table.first();
  report.add_text(fmt::format("{}\n{}{}", text, answers, answers.empty() ? "" : "\n"));
  const std::string caption = fmt::format("{} stable {}", first.question.side(), first.question.path);
  report.show(columns.table(table.rows, caption, layout.in_full()));
  report.add_text("\n" + layout.wrapped(rule_text(first.question.rule, first.scenario), 0) + remarks +
                  notes_text(table, layout));
}

}  // namespace hapbench
