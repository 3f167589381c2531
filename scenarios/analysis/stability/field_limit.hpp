#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/rendering_config.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/batch/axis.hpp"
#include "sim/core/math.hpp"

/// The search for the edge of stable values, whatever makes them stable, and with it the largest or smallest value of a
/// scenario's field at which its run is stable (run_stability.hpp).
namespace hapbench {

inline constexpr int kEdgeIntervals = 16;        ///< equal parts of a way before bisection
inline constexpr double kEdgeResolution = 1e-3;  ///< relative width at which bisection on runs stops by default

/// A range of values as a way from the end that is expected to be stable (part 0) to the other end (part 1).
struct SearchWay {
  Range range;                     ///< where the edge may lie, from < to; both ends are tried
  std::optional<double> own = {};  ///< the value from which the search goes on, if it lies in the range
  bool whole = false;              ///< values are integers
  bool smallest = false;           ///< the way begins at the high end
  /// Width at which bisection stops: relative to the value in a logarithmic range, to the range in a linear one.
  double resolution = kEdgeResolution;

  double value_at(double part) const {
    const double value = range.value_at(smallest ? 1.0 - part : part);
    return whole ? std::round(value) : value;
  }
  std::optional<double> own_part() const {
    if (!own) return std::nullopt;
    const auto [from, to, logarithmic] = range;
    const double part = logarithmic ? math::log(*own / from) / math::log(to / from) : (*own - from) / (to - from);
    return smallest ? 1.0 - part : part;
  }
  /// True while bisection has to go on between two parts.
  bool apart(double a, double b) const {
    const double low = std::min(value_at(a), value_at(b)), high = std::max(value_at(a), value_at(b));
    if (whole) return high - low > 1.0;
    if (range.logarithmic) return high > (1.0 + resolution) * low;
    return high - low > resolution * (range.to - range.from);
  }
};

/// The result of a search, as parts of the way: the interval of stable ones, from `first` to `stable`, and the unstable
/// ones next to it, `before` and `beyond`.
struct FoundEdge {
  std::optional<double> stable = {}, beyond = {};
  std::optional<double> first = {}, before = {};
  bool scattered = false;  ///< there are stable parts, but no stretch of them as long as kNear
};

/// Parts of a way that were tried, and whether they are stable; and who tells that.
using TriedParts = std::map<double, bool>;
using IsStable = std::function<bool(double part)>;

/// The ends of so many equal parts of a way, from its begin on.
TriedParts scanned(int intervals, const IsStable& stable);

/// The first edge behind the own value, or if that is not stable behind the first stable one of the parts `tried` (at
/// least both ends; those of the search are added), by bisection. With `beside`, three values on either side are tried,
/// and an edge before it that they show is narrowed down instead, up to five times; then the other end of the interval.
FoundEdge find_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool beside);

// An interval of stable values is an answer once it was tried between its ends: loops in contact have islands of
// unstable values that are 1 % of a range wide.
inline constexpr std::size_t kTriedBetween = 48;  ///< values between the ends
inline constexpr std::size_t kTriedNear = 8;      ///< and just below the edge,
inline constexpr double kNear = 0.02;             ///< as far as this, relative
/// With no value that fails among so many, at most this share of the interval does, with 95 % confidence.
inline double may_fail_share(std::size_t tried) {
  return 1.0 - math::pow(0.05, 1.0 / static_cast<double>(tried));
}
/// So many parts between two of a way: wherever one ends, those before it fill the interval evenly.
std::vector<double> parts_between(double from, double to, std::size_t count);
/// kTriedNear parts below one whose values are within kNear of its value.
std::vector<double> parts_below(const SearchWay& way, double part);

/// The edge of find_edge with `beside`, of an interval that was tried between its ends and, with `near`, just below its
/// edge: the first value that is not stable becomes the new end. `ahead` hears of parts before they are asked for.
FoundEdge find_tried_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool near,
                          const std::function<void(std::span<const double>)>& ahead);

inline constexpr const char* kStiffnessPath = parameter::kStiffness.field;

/// Which limit of which field of a scene, and by which rule a run is stable.
struct LimitQuestion : StabilityRule, SearchWay {
  const ScenarioText* scene = nullptr;  ///< has to outlive the question
  std::vector<std::string> overrides = {};
  std::string path = {};                   ///< of the field, dotted as in --set
  std::vector<std::string> warnings = {};  ///< of the scenario with the field given
  bool between = true;                     ///< the interval is tried between its ends before it is an answer
  unsigned threads = 1;                    ///< runs at once; no result depends on it

  const char* side() const { return smallest ? "smallest" : "largest"; }
  /// The scene with this value of the field. Throws InputError.
  LoadedScenario at(double value) const {
    std::vector<std::string> all = overrides;
    all.push_back(whole ? fmt::format("{}={:.0f}", path, value) : fmt::format("{}={}", path, value));
    return load_scenario(*scene, all);
  }
};

/// A value and what a run with it came to.
struct JudgedValue {
  double value = 0.0;
  RunVerdict verdict = RunVerdict::stable;
};

/// An end of the interval of stable values around the place where the search began.
struct IntervalEnd {
  std::optional<double> value;        ///< the last stable one; none when no run is stable
  std::optional<JudgedValue> beyond;  ///< the first one beyond it that is not; none when the range ends stable

  /// How far the edge may lie beyond the value: from there to the next one that is not stable; none without one.
  std::optional<double> tolerance() const {
    return value && beyond ? std::optional(std::abs(beyond->value - *value)) : std::nullopt;
  }
};

/// The answer: the end that was asked for.
struct FieldLimit : IntervalEnd {
  IntervalEnd other;
  /// The same by the eigenvalues of a step, where the springs stay in contact; infinite (smallest: 0) when the whole
  /// range is stable, empty where there is no theory or nothing is stable.
  std::optional<double> theory;
  bool theory_has_none = false;  ///< by theory no value of the range is stable
  /// The same by the integrator's inequality, where the tool is alone with the springs; empty where it has none.
  std::optional<double> closed_form;
  /// Of a device at what only pushes, where there is no theory: the edge of the loop of device, hand and the stiffness
  /// rendered at the limit while contact lasts, without dry friction and encoder, which hold up a limit beyond it;
  /// infinite when the whole range is stable.
  std::optional<double> linear;
  /// Of K on a wall that holds the handle of an impedance device from both sides: what stiffness_limits() say, in their
  /// order, and the least edge over hand_family() in place of the scene's hand; empty elsewhere.
  std::vector<std::optional<double>> closed_forms;
  std::optional<double> worst_hand;
  std::string no_theory;           ///< there: why the eigenvalues of the loop tell nothing; empty where they do
  SettledState settled;            ///< the run at `value`
  std::optional<JudgedValue> own;  ///< the run at the scenario's value, if that was in the range
  /// unstable_without_contact, at the value beyond, or without a limit at the first one
  bool unstable_alone = false;
  bool has_effect = true;                 ///< false when the handle moved alike, bit for bit, in all runs
  std::size_t tried_between = 0;          ///< values that were tried between the ends of the interval, all stable
  bool scattered = false;                 ///< there are stable values, but no edge: no stretch of kNear is stable
  std::vector<JudgedValue> runs;          ///< all, by value
  std::vector<JudgedValue> inconsistent;  ///< runs that are unstable in this interval, or stable outside of it
  std::size_t undecided = 0;              ///< runs that were too short to tell (RunStability::undecided)

  /// True where the limit lies beyond `linear`, the one to quote then, by more than this, relative: contact at a stable
  /// value beyond it is intermittent.
  bool is_beyond_linear(double resolution) const { return value && linear && *value > (1.0 + resolution) * *linear; }
  /// Edge of the linear loop: `theory`, or else `linear`.
  const std::optional<double>& linear_edge() const { return theory ? theory : linear; }
};

/// The scenario's own value at a path, or null.
Json own_value(const Scenario& scenario, const std::string& path);

/// The question about a field in a range, or by default between a thousandth and a thousandfold (2^10) of the
/// scenario's own value, as far as the field allows; in ratios when both ends are above 0. Throws InputError, with the
/// file, for a scene without a free position or with fewer than 4 steps, when the field is not a number, when the ends
/// are none of its values, and, without a range, when its value is not above 0.
LimitQuestion limit_question(const ScenarioText& scenario, const std::vector<std::string>& overrides,
                             const std::string& path, std::optional<Range> range);

/// Answers the question: find_edge with `beside`, of 17 values and the scenario's own, or find_tried_edge where the
/// interval is to be tried between its ends. Some 35 to 120 runs, and between the ends 56 or more, as long as one
/// fails. Throws InputError, with the file, where vibration is asked for at a sampling rate of 60 Hz or less.
FieldLimit field_limit(const LimitQuestion& question);

// ---- Devices that a scene is put on in place of its own: those of the program, and files

/// A note on a delay in samples, whose time depends on the scene's step; empty for devices without one.
std::string delay_note(const Scenario& scenario);

/// A device that a scene is tried on.
struct ComparedDevice {
  std::string name;                                ///< "ideal", "admittance", a preset's or its file's
  Json json;                                       ///< the scenario's field "device"
  bool has_place_for_mass = false;                 ///< of a hand that is fixed to the handle
  std::optional<double> published_stiffness = {};  ///< of a preset: the largest stable one of a wall [N/m]
};

/// All of them: both devices with a virtual mass as they are by default, then the presets.
std::vector<ComparedDevice> compared_devices();

/// One of a user's own, named after its file: an object with the fields of a scenario's device, or a scenario with such
/// an object as its `device`. Throws InputError with file and pointer.
ComparedDevice device_of_file(const std::filesystem::path& file);

/// The same with its dry friction times a factor, named touch[friction*2]; nothing for a device that has none.
std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor);

/// A preset with the numbers of both ends of what nobody published (PresetEnd), named touch[soft] and touch[stiff];
/// nothing for another device.
std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device);

/// The overrides that put the scene on the device, before the given ones. A hand with a mass loses it where the device
/// has no place for one; the virtual mass is there instead.
std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides);

}  // namespace hapbench
