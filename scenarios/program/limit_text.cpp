#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "device_model/device_presets.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/limit_cases.hpp"
#include "scenarios/studies/stability/judged_run.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kGridGap = 1;  // three scenes and two algorithms then fit into kTableWidth
constexpr const char* kBeyondLinear =
    "bounces below 30 Hz, dry friction or the end of the run hold the tool, and one that rests on the surface may not "
    "be stable";
constexpr double kNone = std::numeric_limits<double>::infinity();

/// States the question of one scene.
std::string question_text(const LimitQuestion& question, const Scenario& scenario) {
  const std::string width = question.whole ? "1"
                            : question.range.logarithmic
                                ? fmt::format("{} %", 100.0 * question.resolution)
                                : fmt::format("{} % of the range", 100.0 * question.resolution);
  const auto end = [&question](double value) { return significant(question.whole ? std::round(value) : value); };
  return fmt::format("{}: {} stable {} between {} and {}, to {}; {} steps a run\n\n", scenario.name,
                     question.smallest ? "smallest" : "largest", question.path, end(question.range.from),
                     end(question.range.to), width, scenario.time.steps);
}

std::string none_text(const FieldLimit& limit) {
  std::map<RunVerdict, std::size_t> counts;
  for (const JudgedValue& run : limit.runs) ++counts[run.verdict];
  std::vector<std::string> texts;
  for (const auto& [verdict, count] : counts) texts.push_back(fmt::format("{} {}", count, run_verdict_name(verdict)));
  return fmt::format("none of {} values tried is stable: {}", limit.runs.size(), fmt::join(texts, ", "));
}

std::string inconsistent_text(const FieldLimit& limit) {
  constexpr std::size_t kMost = 4;
  std::string text = fmt::format("{}: not one edge:", limit.algorithm);
  for (std::size_t i = 0; i < std::min(kMost, limit.inconsistent.size()); ++i) {
    const JudgedValue& run = limit.inconsistent[i];
    text += fmt::format("{} {} at {}", i == 0 ? "" : ",", run_verdict_name(run.verdict), significant(run.value));
  }
  return text + (limit.inconsistent.size() > kMost ? fmt::format(" and at {} more\n", limit.inconsistent.size() - kMost)
                                                   : "\n");
}

/// Remarks on a limit that is not all of the answer.
std::string remarks_text(const FieldLimit& limit, const LimitQuestion& question) {
  std::string text;
  const auto say = [&](const std::string& what) { text += fmt::format("{}: {}\n", limit.algorithm, what); };
  if (!limit.value) say(none_text(limit));
  if (limit.value && limit.own && !question.holds(limit.own->verdict)) {
    say(fmt::format("{} at the scenario's own {}: the edge is that of the first stable values from the {} end",
                    run_verdict_name(limit.own->verdict), significant(limit.own->value),
                    question.smallest ? "high" : "low"));
  }
  if (limit.theory_has_none) {
    say(fmt::format("by the eigenvalues of a step no value of the range is stable{}",
                    limit.value ? ": the runs are too short for its growth" : ""));
  }
  if (limit.is_beyond_linear(question.resolution)) {
    say(fmt::format(
        "the loop of device, hand and surface, linear and in contact, is stable up to {} only: beyond it {}",
        significant(*limit.linear, 6), kBeyondLinear));
  }
  if (limit.undecided > 0) {
    say(fmt::format("{} runs were too short to tell slow motion from rest, though made up to 64 times as long",
                    limit.undecided));
  }
  if (!limit.has_effect) {
    say(fmt::format("{} has no effect here: the handle moves alike in all {} runs", question.path, limit.runs.size()));
  }
  if (limit.unstable_alone) {
    say(fmt::format("at {} hand and device are unstable by themselves: the tool vibrates without contact, too",
                    significant((limit.beyond ? *limit.beyond : limit.runs.front()).value)));
  }
  return limit.inconsistent.empty() ? text : text + inconsistent_text(limit);
}

bool has_dry_friction(const Scenario& scenario) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  return device != nullptr && device->coulomb > 0.0;
}

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K m) with damping_ratio zeta = {} and rendering.mass_kg m = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

/// As the width of the search allows, or with three digits.
std::string value_text(double value, const std::optional<double>& tolerance = {}) {
  return deserved(value, tolerance ? tolerance : value * 5e-3);
}

/// "800", "120-800" where it is not stable below, "> 800" where the range ends stable.
std::string edge_text(const FieldLimit& limit, double resolution) {
  if (!limit.value) return "none";
  return fmt::format("{}{}{}{}{}",
                     limit.other_beyond ? value_text(*limit.other_value, limit.other_tolerance()) + "-" : "",
                     limit.beyond ? "" : "> ", value_text(*limit.value, limit.tolerance()),
                     limit.is_beyond_linear(resolution) ? "!" : "", limit.inconsistent.empty() ? "" : " ~");
}

/// The delay of each impedance device in the first scene, as "0 of touch; 1 (0.5 ms in steps of 0.5 ms) of mine"; empty
/// when none has one.
std::string delays_text(const LimitTable& table) {
  std::map<std::string, std::vector<std::string>> names;
  for (std::size_t i = 0; i < table.rows.size(); i += table.columns) {
    const LimitRow& row = table.rows[i];
    if (handle_moves_tool(row.scenario.device) && !row.device->name.ends_with(']'))
      append_new(names[delay_text(row.scenario)], {row.device->name});
  }
  std::vector<std::string> parts;
  for (const auto& [delay, having] : names) parts.push_back(fmt::format("{} of {}", delay, fmt::join(having, ", ")));
  if (names.empty() || names.rbegin()->first == "0") return "";
  return wrapped(
      fmt::format("delay_samples: {}; {}; none of a preset is published", fmt::join(parts, "; "), kWhoseSamples), 0);
}

constexpr const char* kWhichStiffness = "which K to quote: device_model/README.md, \"Which K to quote?\"\n";

/// The approach that limits with dry friction belong to, over all cases.
std::string approaches_text(const LimitTable& table) {
  if (std::ranges::none_of(table.rows, [](const LimitRow& row) { return has_dry_friction(row.scenario); })) return "";
  std::pair touches(kNone, 0.0), presses(kNone, 0.0);
  for (const LimitRow& row : table.rows) {
    if (!row.found.value) continue;
    const SettledState& settled = row.found.settled;
    touches = {std::min(touches.first, settled.touch_speed), std::max(touches.second, settled.touch_speed)};
    presses = {std::min(presses.first, settled.press), std::max(presses.second, settled.press)};
  }
  const auto between = [](const std::pair<double, double>& ends) {
    const std::string low = significant(ends.first, 2), high = significant(ends.second, 2);
    return low == high ? low : low + " to " + high;
  };
  return wrapped(
      fmt::format(
          "dry friction holds a hand that presses slowly, and is ours in every preset: the limit is that of this "
          "approach (first touch at {} m/s, pressed with {} N), not of a device; --set device.coulomb_N=0 shows what is "
          "left without",
          between(touches), between(presses)),
      0);
}

/// A line for each case, with the numbers of its search.
std::string detailed_text(const LimitTable& table) {
  std::string text, remarks;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const LimitRow& row = table.rows[i];
    if (i == 0 || row.scene != table.rows[i - 1].scene) text += question_text(row.asked.question, row.scenario);
    remarks += remarks_text(row.found, row.asked.question);
  }
  const LimitRow& first = table.first();
  text += limit_columns(&table).table(table.rows).text() + "\n" +
          wrapped(rule_text(first.asked.question, is_moved(first.scenario)), 0) + remarks + approaches_text(table);
  const bool on_device = std::holds_alternative<ImpedanceDeviceConfig>(first.scenario.device);
  return text + (on_device && first.asked.question.path == "rendering.stiffness_N_per_m" ? kWhichStiffness : "");
}

Table grid(const LimitTable& table) {
  std::vector<Table::Column> columns;
  if (table.has_devices) columns = {{"device", false}};
  for (const std::string& path : table.over) columns.push_back({path});
  if (table.has_devices) columns.push_back({"pub-\nlished"});
  for (std::size_t c = 0; c < table.columns; ++c)
    columns.push_back({table.rows[c].scene + "\n" + table.rows[c].asked.algorithm});
  Table shown(columns, kGridGap);
  for (std::size_t i = 0; i < table.rows.size(); i += table.columns) {
    const LimitRow& first = table.rows[i];
    std::vector<std::string> cells;
    if (table.has_devices) cells.push_back(first.device->name);
    for (const std::string& value : first.values) {
      const auto number = finite_number(value);
      cells.push_back(number ? significant(*number) : value);
    }
    if (table.has_devices) {
      const auto& published = first.device->published_stiffness;
      cells.push_back(published ? value_text(*published) : "-");
    }
    for (std::size_t c = i; c < i + table.columns; ++c)
      cells.push_back(edge_text(table.rows[c].found, table.rows[c].asked.question.resolution));
    shown.add(std::move(cells));
  }
  return shown;
}

/// What is to be known of devices.
std::string devices_text(const LimitTable& table) {
  const auto is_named = [&](char sign) {
    return std::ranges::any_of(
        table.rows, [sign](const LimitRow& row) { return row.device->name.find(sign) != std::string::npos; });
  };
  std::string text = "published: largest stable stiffness of a wall; \"hapbench describe DEVICE\" names its source\n";
  text += kWhichStiffness;
  if (is_named('*')) text += "*: a preset with numbers of --set, of which nothing is published\n";
  if (is_named('[')) {
    text += wrapped(
        fmt::format("[soft], [stiff]: the preset at either end of what nobody published of it ({}); [friction*2]: with "
                    "its dry friction times a factor",
                    kPresetRanges),
        0);
  }
  return text + delays_text(table);
}

/// What the signs in the grid mean.
std::string notes_text(const LimitTable& table) {
  const auto any = [&](auto holds) {
    return std::ranges::any_of(table.rows, [&](const LimitRow& row) { return holds(row.found, row.asked.question); });
  };
  std::string text;
  if (any([](const FieldLimit& limit, const LimitQuestion&) { return limit.other_beyond.has_value(); }))
    text += "a-b: stable from a on only; class_below in limit.csv says what becomes of the run below\n";
  if (any([](const FieldLimit& limit, const LimitQuestion&) { return !limit.value; }))
    text += "none: no value tried is stable; limit_runs.csv says what becomes of each\n";
  if (table.has_devices) text += devices_text(table);
  text += approaches_text(table);
  if (any([](const FieldLimit& limit, const LimitQuestion& asked) {
        return limit.is_beyond_linear(asked.resolution);
      })) {
    text += wrapped(fmt::format("!: beyond the edge of the loop of device, hand and surface, linear and in contact "
                                "(linear in limit.csv): {}",
                                kBeyondLinear),
                    0);
  }
  if (any([](const FieldLimit& limit, const LimitQuestion&) { return !limit.inconsistent.empty(); }))
    text += "~: some values below it are unstable, or some beyond it are stable: limit_runs.csv\n";
  return text;
}

/// The limits alone, a line for each device and value, and how they compare.
std::string grid_text(const LimitTable& table) {
  const LimitQuestion& question = table.first().asked.question;
  std::string text = fmt::format("{} stable {}, to {:.3g} %\n", question.smallest ? "smallest" : "largest",
                                 question.path, 100.0 * question.resolution);
  const bool as_in_first_row = std::ranges::none_of(
      table.over, [](const auto& path) { return path.starts_with("rendering.") || path.starts_with("time."); });
  std::vector<std::string> rules;
  for (std::size_t c = 0; as_in_first_row && c < table.columns; ++c) {
    const Scenario& scenario = table.rows[c].scenario;
    append_new(rules, {fmt::format("{} steps of {} s; {}\n", scenario.time.steps, significant(scenario.time.step),
                                   damping_text(scenario.rendering))});
  }
  return text + fmt::format("{}", fmt::join(rules, "")) + "\n" + grid(table).text() +
         wrapped(rule_text(question, is_moved(table.first().scenario)), 0) + notes_text(table);
}

}  // namespace

std::string limit_text(const LimitTable& table) {
  return table.is_grid() ? grid_text(table) : detailed_text(table);
}

}  // namespace hapbench
