#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/input/bundled_files.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/tool/cylinder.hpp"

/// The claims of the thesis, how each is judged, and the ledger of the verdicts. results/reference/rules.json has their
/// texts, the file of their chapter what is measured and the rule, published.json there the published numbers.
namespace hapbench {

// ---- Published numbers, and what claims are measured by

/// A published number. Parts that are not published have these values.
struct PublishedNumber {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< standard deviation or standard error, whichever is published
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

/// The published numbers by id.
class PublishedNumbers {
 public:
  /// None.
  PublishedNumbers() = default;
  /// Reads the file. Throws InputError.
  explicit PublishedNumbers(const std::filesystem::path& file);
  /// Throws InputError for an id that is not there.
  const PublishedNumber& operator[](const std::string& id) const {
    const auto found = numbers_.find(id);
    if (found == numbers_.end()) throw InputError("the published numbers hold no \"" + id + "\"");
    return found->second;
  }
  /// The text with the numbers that it names by id: <T2.raw> becomes "37.8 ± 17.7", <T3.reduced.bound.at_most> "15".
  /// A part (mean, spread, at_least or at_most) may have a factor and a format, as <J1.depth.mean*1000:.2f>; without
  /// one it is `plain`; no number is "none". Throws InputError for an id that is not there.
  std::string fill(const std::string& text) const;
  /// Adds a number of ours that rules read as they read published ones: a threshold (choices.hpp).
  void set(const std::string& id, double value) { numbers_[id].mean = value; }

 private:
  std::map<std::string, PublishedNumber> numbers_;
};

/// What claims are judged by.
struct Evidence {
  PublishedNumbers published;
  std::filesystem::path directory;  ///< of results, those of a scenario in a subdirectory of its name
  /// Called with a scenario's name before its results are read, to run it.
  std::function<void(const std::string& scenario)> provide;
  /// The overrides of a bundled scenario, as for load_scenario; empty for none.
  std::function<std::vector<std::string>(const Scenario&)> overrides = {};
  /// Called with the name of every bundled scenario that a claim loads by itself; may be empty.
  std::function<void(const std::string& scenario)> used = {};

  // All functions throw InputError, also when the file of a result is missing or none of ours.

  /// A number of a scenario's summary.json, as in "metrics.force_max_N"; NaN for null.
  double number(const std::string& scenario, const std::string& path) const {
    provide(scenario);
    std::string pointer = "/" + path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    const Json summary = read_json(directory / scenario / "summary.json");
    const Json value = summary.value(Json::json_pointer(pointer), Json());
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  }
  /// Columns of a CSV file among its results, by name; a cell without a number is NaN.
  std::map<std::string, std::vector<double>> table(const std::string& scenario, const std::string& file) const {
    provide(scenario);
    const std::filesystem::path path = directory / scenario / file;
    const std::string text = read_named_file(path);
    if (text.empty()) fail_in_file(path, "is empty; allowed: a header and rows");
    CsvReader csv{LineReader(text), path};
    std::vector<std::vector<double>*> columns;
    std::map<std::string, std::vector<double>> table;
    for (const std::string_view name : csv.columns()) columns.push_back(&table[std::string(name)]);
    while (csv.next())
      for (std::size_t i = 0; i < columns.size(); ++i)
        columns[i]->push_back(finite_number(csv.cells()[i]).value_or(std::numeric_limits<double>::quiet_NaN()));
    return table;
  }
  /// A bundled scenario with `overrides`, and then with `more` overrides: a single case.
  Cases scene(const std::string& name, const std::vector<std::string>& more = {}) const {
    if (used) used(name);
    const ScenarioText text = read_scenario_text(find_scenario(name));
    std::vector<std::string> all;
    if (overrides) all = overrides(load_scenario(text, {}).scenario);
    all.insert(all.end(), more.begin(), more.end());
    return {{text}, std::move(all), {}};
  }
  LoadedScenario load(const std::string& name, const std::vector<std::string>& more = {}) const {
    return scene(name, more).load(0);
  }
  /// Runs it in memory.
  Result run(const std::string& name, const std::vector<std::string>& more = {}) const {
    return run_scenario(load(name, more), std::nullopt, false);
  }
};

/// Runs a scenario in memory and calls `row` for each row, with the contacts as found. Throws InputError.
void for_each_row(const LoadedScenario& loaded, const std::function<void(const StepRecord&)>& row);

// ---- Claims and verdicts

/// The outcome of testing a published statement; the last two are those of findings of ours.
enum class Verdict { reproduced, in_kind, not_reproduced, refuted, not_reproducible, holds, does_not_hold };

struct VerdictText {
  std::string_view name;
  const char* meaning;
  const char* mark;  ///< in bars
};
/// In the order of the enumeration.
inline constexpr VerdictText kVerdicts[] = {
    {"reproduced",
     "another implementation, by other authors and from the text alone, meets the claim's rule with the published "
     "numbers (ACM calls that replicated)",
     "✓"},
    {"reproduced in kind", "direction or mechanism are the published ones, the numbers are not", "≈"},
    {"not reproduced", "neither, in this model of the device and the hand", "✗"},
    {"refuted", "it contradicts an exact result", "⊘"},
    {"not reproducible", "no simulation can show it: people or the trainer are needed", "–"},
    {"holds", "a finding of ours that the measurement shows", "✓"},
    {"does not hold", "a finding of ours that the measurement does not show", "✗"}};
inline constexpr std::string_view verdict_name(Verdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].name;
}

/// The verdict of a rule for "reproduced" and a weaker one for "reproduced in kind".
inline Verdict decide(bool reproduced, bool in_kind) {
  return reproduced ? Verdict::reproduced : in_kind ? Verdict::in_kind : Verdict::not_reproduced;
}
/// The verdict on a finding of ours.
inline Verdict found(bool holds) {
  return holds ? Verdict::holds : Verdict::does_not_hold;
}

/// Numbers by name, several under one name where each subject has its own.
using MeasuredValues = std::map<std::string, std::vector<double>>;

/// The measurements in one case of a claim, such as a density or an algorithm.
struct MeasuredCase {
  std::string name;  ///< empty where the claim has a single case
  MeasuredValues values;

  /// The first value of a name. Throws std::out_of_range for one without.
  double operator[](const std::string& value) const { return all(value).at(0); }
  const std::vector<double>& all(const std::string& value) const { return values.at(value); }
};

/// All numbers that decide a claim beside the published ones, so that it can be judged again at any time.
using Measured = std::vector<MeasuredCase>;

/// The result of judging a claim, computed from measured numbers.
struct Finding {
  Verdict verdict = Verdict::not_reproducible;
  std::string why = {};       ///< one sentence: which part of the rule decided
  std::string measured = {};  ///< the numbers, for people; empty where rules.json has their text
  std::string brief = {};     ///< the deciding number, of a main result
  Measured cases = {};        ///< what was judged
};

using Measure = Measured (*)(const Evidence& evidence);
using Judge = Finding (*)(const Measured& measured, const PublishedNumbers& published);

/// How a claim is measured, and judged by that alone. A constant that is no choice stands in the claim's text, too.
struct ClaimRule {
  const char* id = nullptr;
  Measure measure = nullptr;
  Judge judge = nullptr;
};

/// Appends an item to an enumeration in words.
inline void append_item(std::string& list, std::string_view item, std::string_view separator = "; ") {
  if (!list.empty()) list += separator;
  list += item;
}

/// A number as the rules of claims write it, with six digits at most: "0.1", "15", "1e-9".
inline std::string plain(double number) {
  std::string text = fmt::format("{:g}", number);
  // An exponent without its leading zero.
  if (const auto exponent = text.find("e-0"); exponent != std::string::npos) text.erase(exponent + 2, 1);
  return text;
}

/// A row of rules.json with its rule. Texts hold published numbers by id, which PublishedNumbers::fill puts in. A
/// threshold of ours is a choice on record without fields, such as rule.easily; the rule's text names it in the same
/// way, which also tells that the choice reaches the claim.
struct Claim {
  std::string id = {};
  std::string place = {};      ///< in the thesis
  std::string claim = {};      ///< in our words
  std::string published = {};  ///< its numbers, for people
  std::string rule = {};       ///< of the verdict, for people, with its thresholds
  std::string why = {};        ///< why no simulation can show it; empty where one can
  std::string measured = {};   ///< for people, with measured numbers, as <rows> or <40 N.depth> of a case
  std::string each = {};       ///< the same of each case, for whose name {} stands; after `measured`
  Measure measure = nullptr;   ///< null, as `judge`, for a claim that no simulation can show
  Judge judge = nullptr;
  bool timing = false;  ///< the finding holds times, so no two runs agree
  bool ours = false;    ///< found on the way: no claim of the thesis, and not counted among those
  bool costly = false;  ///< takes long to measure: judged again for a part of a sample only (choices.hpp)
  bool drawn = false;   ///< a figure draws the numbers of its cases, which the ledger then holds

  /// A main result in a few words: claim, published and, with measured numbers, ours. Empty for other claims.
  struct Main {
    std::string claim = {}, published = {}, ours = {};
  } main = {};

  /// Measures and judges it. Throws InputError.
  Finding finding(const Evidence& evidence) const;
};

/// A claim with the verdict on it.
struct JudgedClaim {
  Claim claim;
  Finding finding;
  std::vector<std::string> scenarios = {};  ///< bundled ones that it was measured with, in the order of their names
  std::string reach = {};                   ///< of the choices, as Choices::reach has it; empty: none reaches it
  double seconds = 0.0;                     ///< to run its scenarios and to measure it

  /// Whether another reading of the choices could change the verdict.
  bool can_be_sampled() const {
    return !claim.timing && finding.verdict != Verdict::not_reproducible && !reach.empty();
  }
};

/// All of them, in the order of the ledger. Throws InputError for a file without what a claim needs.
std::vector<Claim> all_claims();

/// A threshold of ours: the choice rule.NAME.
inline double threshold(const PublishedNumbers& numbers, const std::string& name) {
  return numbers["rule." + name].mean;
}

/// The algorithm that the thesis proposes.
inline constexpr const char* kProposedLaw = "shaped_stiffness";

/// The rule of a claim with a single case.
template <MeasuredValues (*measure)(const Evidence&), Finding (*judge)(const MeasuredCase&, const PublishedNumbers&)>
ClaimRule single_case(const char* id) {
  return {id,
          [](const Evidence& e) {
            return Measured{{"", measure(e)}};
          },
          [](const Measured& measured, const PublishedNumbers& p) { return judge(measured.at(0), p); }};
}

// ---- Measurements and scenes that several claims share

inline const Cylinder kDrill;
inline const ToolPose kUpright{Vec3::Zero(), {0.0, 0.0, -1.0}};

/// A wall point with normal +x, `beyond` the median line of an upright tool (so beyond > 0: the tool's axis is inside).
inline ContactBuffer wall_point(double beyond, const char* depth_model) {
  ContactBuffer contacts(1);
  contacts.push(0, {beyond, 0.0, 0.001}, Vec3::UnitX());
  find_depth_model(depth_model)->make()->evaluate(kDrill, kUpright, contacts);
  contacts.pad();
  return contacts;
}

/// How often what a claim times is repeated.
inline constexpr int kRepetitions = 20;

/// Seconds of a call of `work`: the least of `repetitions`, or of as many as a second allows.
template <class Work>
double seconds_of(int repetitions, Work work) {
  using Clock = std::chrono::steady_clock;
  double least = 0.0, all = 0.0;
  for (int i = 0; i < repetitions && all < 1.0; ++i) {
    const auto start = Clock::now();
    work();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (i == 0 || seconds < least) least = seconds;
    all += seconds;
  }
  return least;
}

/// A scenario in which a hand presses a drill into the block's hole, for measuring: with an ideal device of the same
/// force limit, which adds no dynamics of its own, for one period of the tilt, and without records.
inline Scenario drill_in_hole(Scenario scenario) {
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  constexpr double kPeriod = 6.0;  // [s], of the tilt of task 2
  const auto rows = static_cast<std::int64_t>(std::llround(kPeriod / scenario.time.step));
  scenario.time.steps = std::min(scenario.time.steps, rows);
  scenario.record = {};
  return scenario;
}

/// Before or after the scenario's point stages.
enum class Points { colliding, rendered };

/// The points of every `stride`-th row of drill_in_hole(scenario) that has contact, with depth and gradient.
std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride,
                                        Points points = Points::colliding);

/// The largest set, of at least one, and its size, 0 without any.
inline ContactBuffer largest_of(const std::vector<ContactBuffer>& sets) {
  return *std::ranges::max_element(sets, {}, &ContactBuffer::size);
}
inline std::size_t largest_size(const std::vector<ContactBuffer>& sets) {
  return sets.empty() ? 0 : largest_of(sets).size();
}

/// Seconds of `work` with a copy of each set, one after the other, and of copying them.
template <class Work>
double seconds_with(const std::vector<ContactBuffer>& sets, int repetitions, Work work) {
  ContactBuffer copy(largest_size(sets));
  return seconds_of(repetitions, [&] {
    for (const ContactBuffer& set : sets) {
      copy.assign(set);
      work(copy);
    }
  });
}

/// Total variation of the velocity [m/s], power of the velocity above 30 Hz [m^2/s^2] and reversals of the force.
inline MeasuredCase vibration(const std::string& name, const Result& run) {
  const auto number = [&](const char* metric) { return number_of(run.metrics, metric).value_or(0.0); };
  return {name,
          {{"velocity_variation", {number("velocity_total_variation_m_per_s")}},
           {"vibration_power", {number("vibration_power_above_30Hz_m2_per_s2")}},
           {"force_reversals", {number("force_reversals")}}}};
}

/// True if `a` has more variation and power.
inline bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b) {
  return a["velocity_variation"] > b["velocity_variation"] && a["vibration_power"] > b["vibration_power"];
}
/// Whether an algorithm vibrates, compared with a smooth one: it has rule.vibrates times the total variation and the
/// square of it times the power; or more of both, and so many times the reversals of the force.
inline bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p) {
  const double more = threshold(p, "vibrates");
  const bool moves = a["velocity_variation"] >= more * b["velocity_variation"] &&
                     a["vibration_power"] >= more * more * b["vibration_power"];
  return moves || (vibrates_more(a, b) && a["force_reversals"] >= more * std::max(1.0, b["force_reversals"]));
}

/// The damping ratio of a swing about zero [m], a value for each row, from the ratio q of successive extremes,
/// zeta = -ln q / sqrt(pi^2 + ln^2 q). An extreme within a micrometre of zero ends the decay: rounding and grazing
/// contact are no swings. None with fewer than two extremes.
std::optional<double> damping_ratio_of_swings(std::span<const double> x);

// ---- The rules, by chapter

std::vector<ClaimRule> chapters_1_and_4();        ///< V, S1, B1b, B5, G, B4, C1 to C3, C7, C8
std::vector<ClaimRule> chapter_3();               ///< T1 to T3, T2b, J, C5, R, L
std::vector<ClaimRule> chapter_3_cost();          ///< T4, T5, P2, F3
std::vector<ClaimRule> appendix_a();              ///< A
std::vector<ClaimRule> appendix_b_c_f();          ///< B1 to B3, P1, C6, F1, F2
std::vector<ClaimRule> appendix_d_experiments();  ///< D

// ---- The ledger

/// claims.json: the headline and the claims; with the cases of those whose numbers a figure draws. `robustness` has
/// what robustness.json holds; of a claim it counts if the recorded verdict is this one and the choices that reach it
/// are the same. Throws InputError when it is no such record.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness);
std::string headline_of(const Json& claims);  ///< how many have which verdict, and how many verdicts are steady

/// claims.md, of what ledger_json gives: the main results, counts by chapter, the claims of the thesis, those that are
/// contradicted first, what was found on the way.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
