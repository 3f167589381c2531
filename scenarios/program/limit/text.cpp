#include "scenarios/program/limit/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/run/scripted_motion.hpp"

namespace hapbench {
namespace {

constexpr const char* kBeyondLinear =
    "beyond it stable runs are intermittent contact: bounces below 30 Hz, dry friction or the end of the run hold the "
    "tool, and one that rests on the surface may not be stable";

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K m) with damping_ratio zeta = {} and rendering.mass_kg m = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

/// Returns the resolution of the bisection.
std::string resolution_text(const LimitQuestion& question) {
  const SearchWay& search = question.search;
  if (search.whole) return "1";
  return fmt::format("{} %{}", 100.0 * search.resolution, search.range.logarithmic ? "" : " of the range");
}

/// States the question for one scene. `over`: other fields vary too, so that values which depend on them are
/// omitted.
std::string question_text(const LimitQuestion& question, const Scenario& scenario, bool over, const Layout& layout) {
  const SearchWay& search = question.search;
  const std::string width = resolution_text(question);
  const auto end = [&search](double value) { return significant(search.whole ? std::round(value) : value); };
  std::string text = fmt::format("{}: {} stable {} between {} and {}, to {}", scenario.name, question.side(),
                                 question.path, end(search.range.from), end(search.range.to), width);
  if (!over) text += fmt::format("; {} steps", scenario.time.steps);
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
  return fmt::format("{} of {} values tried is stable: {}",
                     limit.scattered
                         ? fmt::format("no edge, stable values are scattered: no stretch of {:g} %", 100.0 * kNear)
                         : "none",
                     limit.runs.size(), fmt::join(texts, ", "));
}

/// Returns remarks on the answer of one row; may be empty.
std::string remarks_text(const LimitRow& row, const Layout& layout) {
  const FieldLimit& limit = row.limit;
  const LimitQuestion& question = row.asked;
  std::string text;
  const auto say = [&](const std::string& what) { text += layout.wrapped(row.algorithm() + ": " + what, 0); };
  if (limit.end.value && limit.own && !question.rule.holds(limit.own->verdict)) {
    say(fmt::format("{} at the scenario's own {}: the edge is that of the first stable values from the {} end",
                    run_verdict_name(limit.own->verdict), significant(limit.own->value),
                    question.search.smallest ? "high" : "low"));
  }
  if (limit.theory_has_none)
    say(fmt::format("by the eigenvalues of a step no value of the range is stable{}",
                    limit.end.value ? ": the runs are too short for its growth" : ""));
  if (limit.undecided > 0)
    say(fmt::format("{} runs were too short to tell slow motion from rest, though made up to 64 times as long",
                    limit.undecided));
  if (!limit.has_effect)
    say(fmt::format("{} has no effect here: the handle moves alike in all {} runs", question.path, limit.runs.size()));
  if (limit.unstable_alone)
    say(fmt::format("at {} hand and device are unstable by themselves: the tool also vibrates without contact",
                    significant((limit.end.beyond ? *limit.end.beyond : limit.runs.front()).value)));
  return text;
}

/// Returns notes that explain the table's columns and marks.
std::string notes_text(const LimitTable& table, const Layout& layout) {
  std::optional<double> friction;  // largest Coulomb friction of a handle [N]; empty without impedance devices
  for (const LimitRow& row : table.rows)
    if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&row.scenario.device))
      friction = std::max(friction, std::optional(device->coulomb));
  const auto is_beyond_linear = [](const LimitRow& row) {
    return row.limit.is_beyond_linear(row.asked.search.resolution);
  };
  const auto is_published = [](const ComparedDevice& device) { return device.published_stiffness.has_value(); };
  std::string names;
  for (const ComparedDevice& device : table.devices) names += device.name + " ";
  const auto is_marked = [&names](const char* mark) { return names.find(mark) != std::string::npos; };
  const std::pair<bool, std::string> notes[] = {
      {table.is_grid() && std::ranges::any_of(table.rows, is_beyond_linear),
       fmt::format("linear edge: of the loop of device, hand and surface while they touch; {}", kBeyondLinear)},
      {table.is_grid(),
       "a table tries no values between those of its searches, as the limit of one scene does. inconsistent: values "
       "that are unstable before an edge or stable beyond it; limit_runs.csv has what becomes of each value"},
      {std::ranges::any_of(table.devices, is_published),
       "published: largest stable stiffness of a wall (\"hapbench describe DEVICE\" names its source)"},
      {is_marked("* "), "*: a preset with numbers of --set, of which nothing is published"},
      {is_marked("[soft]"),
       fmt::format("[soft], [stiff]: the preset at either end of what nobody published of it ({})", kPresetRanges)},
      {is_marked("[friction*"), "[friction*2]: with its dry friction times a factor"},
      {table.first().asked.path == kStiffnessPath && friction.has_value(),
       "which K to quote: device_model/README.md, \"Which K to quote?\""},
      {friction > 0.0,
       "dry friction, which is ours in every preset, holds a hand that presses slowly: the limit is that of this "
       "approach, not of a device; --set device.coulomb_N=0 shows what is left without"}};
  std::string text;
  for (const auto& [holds, note] : notes)
    if (holds) text += layout.wrapped(note, 0);
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
      rule.most_vibration
          ? fmt::format(
                "stable: at most {} m/s rms above {:.0f} Hz at the handle, from a quarter of the contact on, and no "
                "bounces below that go on",
                *rule.most_vibration, kVibrationCutoff)
          : fmt::format("stable: comes to rest or dies out{}", rule.bounded ? ", or vibrates without growing" : "");
  if (!rule.most_vibration && is_moved(scenario))
    text +=
        ", as far as it is above 30 Hz and 1 mm/s, because a script moves the tool; where that ends in the first "
        "half of a run, all beyond 1 mm/s from then on";
  for (const auto& [metric, bound] : rule.bounds) {
    if (bound.min) text += fmt::format(", {} >= {}", metric, *bound.min);
    if (bound.max) text += fmt::format(", {} <= {}", metric, *bound.max);
  }
  return text;
}

std::string limit_answer(const FieldLimit& found, double resolution) {
  if (!found.end.value) return none_text(found);
  std::string text = found.end.beyond
                         ? fmt::format("edge in runs {}", deserved(*found.end.value, found.end.tolerance()))
                         : fmt::format("stable in runs to the end of the range, {}", significant(*found.end.value, 6));
  const auto& linear = found.linear_edge();
  if (linear && std::isfinite(*linear) && *linear > 0.0) {
    const std::string edge = fmt::format("linear edge {}; ", significant(*linear, 6));
    text = edge + (found.is_beyond_linear(resolution) ? fmt::format("{} ({})", kBeyondLinear, text) : text);
  }
  if (found.tried_between == 0) return text;
  return text + fmt::format("; {} values between its ends are also stable: at most {:.0f} % of them may fail (95 %)",
                            found.tried_between, 100.0 * may_fail_share(found.tried_between));
}

std::string limits_text(const LimitTable& table, const Columns<LimitRow>& columns, const Layout& layout) {
  std::string text, answers, remarks;
  for (std::size_t i = 0; i < table.columns(); ++i) {
    const LimitRow& row = table.rows[i];
    if (i == 0 || row.scene() != table.rows[i - 1].scene())
      text += question_text(row.asked, row.scenario, table.over() > 0, layout);
    if (table.is_grid()) continue;
    answers +=
        layout.wrapped(fmt::format("{}: {}", row.algorithm(), limit_answer(row.limit, row.asked.search.resolution)), 0);
    remarks += remarks_text(row, layout);
  }
  const LimitRow& first = table.first();
  return fmt::format("{}\n{}{}{}\n{}{}{}", text, answers, answers.empty() ? "" : "\n", columns.text(table.rows, layout),
                     layout.wrapped(rule_text(first.asked.rule, first.scenario), 0), remarks,
                     notes_text(table, layout));
}

}  // namespace hapbench
