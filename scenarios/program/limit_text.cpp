#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "device_model/device_presets.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/limit_answers.hpp"
#include "scenarios/studies/stability/judged_run.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kGridGap = 1;  // three scenes and two algorithms then fit into kTableWidth
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
        "the loop of device, hand and surface, linear and in contact, is stable up to {} only: beyond it bounces, dry "
        "friction or the end of the run hold the tool, and one that rests on the surface may not be stable",
        significant(*limit.linear, 6)));
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
std::string limit_text(const FieldLimit& limit, double resolution) {
  if (!limit.value) return "none";
  return fmt::format("{}{}{}{}{}",
                     limit.other_beyond ? value_text(*limit.other_value, limit.other_tolerance()) + "-" : "",
                     limit.beyond ? "" : "> ", value_text(*limit.value, limit.tolerance()),
                     limit.is_beyond_linear(resolution) ? "!" : "", limit.inconsistent.empty() ? "" : " ~");
}

/// The first three names, and how many more there are.
std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  const std::size_t shown = std::min(kMost, names.size());
  const std::string more = names.size() > kMost ? fmt::format(" and {} more (limit.csv)", names.size() - kMost) : "";
  return fmt::format("{}{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "), more);
}

/// The delay of each impedance device in the first scene, as "0 of touch; 1 (0.5 ms in steps of 0.5 ms) of mine"; empty
/// when none has one.
std::string delays_text(const LimitCases& asked) {
  std::map<std::string, std::vector<std::string>> names;
  for (std::size_t row = 0; row < asked.rows(); ++row) {
    const Scenario& scenario = asked.scenario(row, 0);
    if (handle_moves_tool(scenario.device) && !asked.device(row).name.ends_with(']'))
      add_once(names[delay_text(scenario)], asked.device(row).name);
  }
  std::vector<std::string> parts;
  for (const auto& [delay, having] : names) parts.push_back(fmt::format("{} of {}", delay, fmt::join(having, ", ")));
  if (names.empty() || names.rbegin()->first == "0") return "";
  return wrapped(
      fmt::format("delay_samples: {}; {}; none of a preset is published", fmt::join(parts, "; "), kWhoseSamples), 0);
}

constexpr const char* kWhichStiffness = "which K to quote: device_model/README.md, \"Which K to quote?\"\n";

/// The approach that limits with dry friction belong to, over all cases.
std::string approaches_text(const std::vector<FieldLimit>& limits) {
  std::pair touches(kNone, 0.0), presses(kNone, 0.0);
  for (const FieldLimit& limit : limits) {
    if (!limit.value) continue;
    touches = {std::min(touches.first, limit.settled.touch_speed), std::max(touches.second, limit.settled.touch_speed)};
    presses = {std::min(presses.first, limit.settled.press), std::max(presses.second, limit.settled.press)};
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

}  // namespace

LimitRatio LimitAnswers::ratio(std::size_t row, std::size_t column) const {
  const FieldLimit &limit = at(row, column), &reference = at(row, 0);
  if (!limit.value || !reference.value) return {};
  const double value = *limit.value / *reference.value, lambda = reference.settled.lambda_max;
  return {value, lambda > 0.0 ? std::optional(value * limit.settled.lambda_max / lambda) : std::nullopt};
}

std::string LimitAnswers::text() const {
  return asked_.is_grid() ? grid_text() : detailed_text();
}

/// A line for each case, with the numbers of its search.
std::string LimitAnswers::detailed_text() const {
  std::string text, remarks;
  bool has_friction = false;
  for (std::size_t column = 0; column < asked_.columns(); ++column) {
    const LimitQuestion& question = asked_.at(0, column).question;
    const Scenario& scenario = asked_.scenario(0, column);
    const bool is_first = column == 0 || asked_.scene_name(column) != asked_.scene_name(column - 1);
    if (is_first) text += question_text(question, scenario);
    remarks += remarks_text(at(0, column), question);
    has_friction = has_friction || has_dry_friction(scenario);
  }
  const LimitCase& first = asked_.at(0, 0);
  const Scenario& scenario = asked_.scenario(0, 0);
  text += limit_columns(this).table(rows_of(*this)).text() + "\n" +
          wrapped(rule_text(first.question, is_moved(scenario)), 0) + remarks +
          (has_friction ? approaches_text(limits_) : "");
  const bool on_device = std::holds_alternative<ImpedanceDeviceConfig>(scenario.device);
  return text + (on_device && first.question.path == "rendering.stiffness_N_per_m" ? kWhichStiffness : "");
}

/// The limits alone, a line for each device and value, and how they compare.
std::string LimitAnswers::grid_text() const {
  const LimitQuestion& question = asked_.at(0, 0).question;
  std::string text = fmt::format("{} stable {}, to {:.3g} %\n", question.smallest ? "smallest" : "largest",
                                 question.path, 100.0 * question.resolution);
  const std::vector<std::string> over = asked_.over();
  const bool as_in_first_row = std::ranges::none_of(
      over, [](const auto& path) { return path.starts_with("rendering.") || path.starts_with("time."); });
  std::vector<std::string> rules;
  for (std::size_t column = 0; as_in_first_row && column < asked_.columns(); ++column) {
    const Scenario& scenario = asked_.scenario(0, column);
    add_once(rules, fmt::format("{} steps of {} s; {}\n", scenario.time.steps, significant(scenario.time.step),
                                damping_text(scenario.rendering)));
  }
  return text + fmt::format("{}", fmt::join(rules, "")) + "\n" + grid().text() +
         wrapped(rule_text(question, is_moved(asked_.scenario(0, 0))), 0) + ends_text() + notes_text();
}

std::string LimitAnswers::row_name(std::size_t row) const {
  std::vector<std::string> names;
  if (asked_.has_devices()) names.push_back(asked_.device(row).name);
  const std::vector<std::string> paths = asked_.over(), values = asked_.values(row);
  for (std::size_t i = 0; i < paths.size(); ++i) names.push_back(paths[i] + "=" + values[i]);
  return fmt::format("{}", fmt::join(names, " "));
}

Table LimitAnswers::grid() const {
  std::vector<Table::Column> columns;
  if (asked_.has_devices()) columns = {{"device", false}};
  for (const std::string& path : asked_.over()) columns.push_back({path});
  if (asked_.has_devices()) columns.push_back({"pub-\nlished"});
  for (std::size_t c = 0; c < asked_.columns(); ++c) columns.push_back({title(c)});
  Table table(columns, kGridGap);
  for (std::size_t row = 0; row < asked_.rows(); ++row) {
    std::vector<std::string> cells;
    if (asked_.has_devices()) cells.push_back(asked_.device(row).name);
    for (const std::string& value : asked_.values(row)) {
      const auto number = finite_number(value);
      cells.push_back(number ? significant(*number) : value);
    }
    if (asked_.has_devices()) {
      const auto& published = asked_.device(row).published_stiffness;
      cells.push_back(published ? value_text(*published) : "-");
    }
    for (std::size_t c = 0; c < asked_.columns(); ++c)
      cells.push_back(limit_text(at(row, c), asked_.at(row, c).question.resolution));
    table.add(std::move(cells));
  }
  return table;
}

/// Lines that tell where runs below the low end fail, and how, and where no value at all is stable.
std::string LimitAnswers::ends_text() const {
  std::map<std::string, std::vector<std::string>> below, none;
  for (std::size_t row = 0; row < asked_.rows(); ++row) {
    for (std::size_t c = 0; c < asked_.columns(); ++c) {
      const FieldLimit& limit = at(row, c);
      const std::string name =
          fmt::format("{} with {} in {}", row_name(row), asked_.algorithm(c), asked_.scene_name(c));
      if (!limit.value) none[none_text(limit)].push_back(name);
      if (limit.other_beyond) below[std::string(run_verdict_name(limit.other_beyond->verdict))].push_back(name);
    }
  }
  std::string text;
  for (const auto& [verdict, names] : below)
    text += wrapped(fmt::format("a-b: stable from a on; below, {}: {}", verdict, first_of(names)), 0);
  for (const auto& [why, names] : none) text += wrapped(fmt::format("{}: {}", first_of(names), why), 0);
  return text;
}

/// What the signs in the grid mean, and what to know of devices.
std::string LimitAnswers::notes_text() const {
  std::string text;
  const auto any = [&](auto holds) {
    for (std::size_t row = 0; row < asked_.rows(); ++row) {
      for (std::size_t c = 0; c < asked_.columns(); ++c)
        if (holds(row, c)) return true;
    }
    return false;
  };
  if (asked_.has_devices()) {
    const auto is_named = [&](char sign) {
      return any([&](std::size_t row, std::size_t) { return asked_.device(row).name.find(sign) != std::string::npos; });
    };
    text += "published: largest stable stiffness of a wall; \"hapbench describe DEVICE\" names its source\n";
    text += kWhichStiffness;
    if (is_named('*')) text += "*: a preset with numbers of --set, of which nothing is published\n";
    if (is_named('['))
      text += wrapped(
          fmt::format(
              "[soft], [stiff]: the preset at either end of what nobody published of it ({}); [friction*2]: with "
              "its dry friction times a factor",
              kPresetRanges),
          0);
    text += delays_text(asked_);
  }
  if (any([&](std::size_t row, std::size_t c) { return has_dry_friction(asked_.scenario(row, c)); }))
    text += approaches_text(limits_);
  if (any([&](std::size_t row, std::size_t c) {
        return at(row, c).is_beyond_linear(asked_.at(row, c).question.resolution);
      })) {
    text += wrapped(
        "!: beyond the edge of the loop of device, hand and surface, linear and in contact (linear in limit.csv): bounces "
        "below 30 Hz, dry friction or the end of the run hold the tool, and one that rests on the surface may not be "
        "stable",
        0);
  }
  if (any([&](std::size_t row, std::size_t c) { return !at(row, c).inconsistent.empty(); }))
    text += "~: some values below it are unstable, or some beyond it are stable: limit_runs.csv\n";
  return text;
}

}  // namespace hapbench
