#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/input/largest_sizes.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/parts.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {

Scenario::Scenario() = default;
Scenario::Scenario(const Scenario&) = default;
Scenario::Scenario(Scenario&&) noexcept = default;
Scenario& Scenario::operator=(const Scenario&) = default;
Scenario& Scenario::operator=(Scenario&&) noexcept = default;
Scenario::~Scenario() = default;

// ---- Rules between the fields of a scenario, which a schema cannot express. ----

namespace {

constexpr double kMostDelaySamples = 1e6;  ///< longest reaction delay of a simulated subject [time steps]
constexpr double kLongestDrag = 1e6;       ///< entries of the table of a path over a surface
/// Shortest length of a direction: the square of a much shorter one would lose digits.
constexpr double kShortestDirection = 1e-12;

void check_sizes(const Scenario& scenario, double steps) {
  if (!(steps >= 1.0 && steps <= kMostSteps)) {
    fail_at("/time/duration_s",
            fmt::format("got {:.3g} steps (duration_s / step_s); allowed: 1 ... {:.0g}", steps, kMostSteps));
  }
  const double rows = steps / static_cast<double>(scenario.record.every);
  if (records_rows(scenario.record) && rows > kMostRows) {
    fail_at("/record/every", fmt::format("got {:.3g} recorded rows; allowed: at most {:.0g}, record less often or less",
                                         rows, kMostRows));
  }
  // Every step of every trial has its time in memory.
  if (scenario.record.timing)
    require_at_most(kMostRows, steps * trial_count(scenario.hand), "/record/timing", "timed steps");
}

void check_orientation(const MotionFields& motion) {
  if (!motion.orientation) return;
  const Vec3 &up = motion.orientation->up, &lean = motion.orientation->lean;
  // 1e-9 forgives the rounding of directions that were normalised by somebody else.
  if (up.norm() >= kShortestDirection && lean.norm() >= kShortestDirection &&
      std::abs(up.dot(lean)) <= 1e-9 * up.norm() * lean.norm())
    return;
  fail_at("/motion/orientation", fmt::format("got up {} and lean {}; allowed: two perpendicular directions, not zero",
                                             shown(up), shown(lean)));
}

template <class Type, class Variant>
bool is(const Variant& value) {
  return std::holds_alternative<Type>(value);
}

bool is_zero(const Profile& profile) {
  return profile.is_constant() && profile(0.0) == 0.0;
}

bool has_other_contacts(const Scenario& scenario) {
  return scenario.rendering.contact_source != kOwnContacts;
}

/// A combination of fields that is refused.
struct Rule {
  const char* at;
  const char* problem;  ///< with {} for the source of contacts
  bool (*is_broken)(const Scenario& scenario);
};

/// A later rule may rely on the earlier ones.
constexpr Rule kRules[] = {
    {"/rendering/local_average", "got true; allowed: false, because springs have no grid cells",
     [](const Scenario& s) { return s.rendering.local_average && is<SpringsEnvironment>(s.environment); }},
    {"/rendering/local_average", "got true; allowed: false, unless environment.grid_m gives the cells",
     [](const Scenario& s) {
       const auto* shell = std::get_if<PointShellEnvironment>(&s.environment);
       const auto* mesh = std::get_if<MeshEnvironment>(&s.environment);
       return s.rendering.local_average && ((shell != nullptr && !shell->grid) || (mesh != nullptr && !mesh->grid));
     }},
    {"/record/ideal_trajectory",
     "got true; allowed: false, unless the environment is block_with_hole and the tool a cylinder with a flat tip",
     [](const Scenario& s) {
       const auto* cylinder = std::get_if<CylinderFields>(&s.tool);
       const bool is_flat = cylinder != nullptr && cylinder->tip == Tip::flat;
       return s.record.ideal_trajectory && !(is<BlockEnvironment>(s.environment) && is_flat);
     }},
    {"/integrator/tolerance_s", "allowed for integrator.type \"event\" only",
     [](const Scenario& s) { return s.integrator.type != &kEvent && s.integrator.tolerance != kEventTolerance; }},
    {"/reference_force", "contradicts motion.position of type \"free\"; allowed with a way that is known beforehand",
     [](const Scenario& s) { return s.reference_force && is<FreePosition>(s.motion.position); }},
    {"/record/force_reference",
     "got true; allowed: false, unless there is a reference_force or motion.position is of type \"file\"",
     [](const Scenario& s) {
       return s.record.force_reference && !s.reference_force && !is<RecordedPosition>(s.motion.position);
     }},
    {"/hand/type", "got \"push\", which pushes along z; allowed in the plane of \"hole_2d\": \"force\"",
     [](const Scenario& s) { return is<PushHandFields>(s.hand) && is<Hole2d>(s.environment); }},
    {"/hand/type", "got \"drag\" with springs, which have no surface; allowed: environments that have one",
     [](const Scenario& s) { return is<DragHandFields>(s.hand) && is<SpringsEnvironment>(s.environment); }},
    {"/motion/position/type", "got a prescribed position; allowed: \"free\" with hand \"drag\", which moves the tool",
     [](const Scenario& s) { return is<DragHandFields>(s.hand) && !is<FreePosition>(s.motion.position); }},
    {"/motion/orientation",
     "got tilt_rad, azimuth_rad or roll_rad together with hand \"drag\", which turns the tool; allowed: without, or "
     "hand.tilt_rad null",
     [](const Scenario& s) {
       const auto* drag = std::get_if<DragHandFields>(&s.hand);
       if (drag == nullptr || !drag->tilt) return false;
       const OrientationFields& orientation = *s.motion.orientation;
       return !(is_zero(orientation.tilt) && is_zero(orientation.azimuth) && is_zero(orientation.roll));
     }},
    {"/motion/position/type",
     "got a prescribed position; allowed: \"free\" with hand \"tracking\", which moves the tool",
     [](const Scenario& s) { return is<TrackingHandFields>(s.hand) && !is<FreePosition>(s.motion.position); }},
    // The contacts of a trace belong to its motion, and neither they nor those of a library are points of our shell.
    {"/rendering/contact_source", "got \"{}\"; allowed: \"own\", with springs, which have no surface",
     [](const Scenario& s) { return has_other_contacts(s) && is<SpringsEnvironment>(s.environment); }},
    {"/rendering/contact_source",
     "got \"{}\"; allowed: \"own\", unless motion.position is prescribed, as it was when the contacts were recorded",
     [](const Scenario& s) {
       return s.rendering.contact_source == kTrace && (position_is_free(s.motion) || handle_moves_tool(s.device));
     }},
    {"/rendering/contact_source", "got \"{}\"; allowed: \"own\", with local_average, which merges shell points",
     [](const Scenario& s) { return has_other_contacts(s) && s.rendering.local_average; }},
    {"/rendering/contact_source",
     "got \"{}\"; allowed: \"own\", with reduction.shuffle_seed, which orders shell points",
     [](const Scenario& s) {
       return has_other_contacts(s) && s.rendering.reduction && s.rendering.reduction->shuffle_seed;
     }},
    // The rules below are about the virtual mass between hand and tool, which an impedance device does not have.
    {"/hand/type",
     "got \"mass_spring_damper\", which is fixed to the handle of device \"impedance\"; allowed with other devices: "
     "\"impedance\", the same spring and damper without the mass",
     [](const Scenario& s) { return is<MassSpringDamperHandFields>(s.hand) && !handle_moves_tool(s.device); }},
    {"/motion/position/type",
     "got a prescribed position; allowed: \"free\" with device \"impedance\", whose handle moves the tool",
     [](const Scenario& s) { return handle_moves_tool(s.device) && !is<FreePosition>(s.motion.position); }},
    {"/rendering/passivity_controller",
     "got true; allowed: false with device \"impedance\": the controller looks ahead by the virtual mass, which is "
     "not there",
     [](const Scenario& s) { return handle_moves_tool(s.device) && s.rendering.passivity_controller; }},
    {"/rendering/force_stage/max_damping_N_s_per_m",
     "got null; allowed with device \"impedance\" or a prescribed position: a number, because there is no virtual mass "
     "to take it from",
     [](const Scenario& s) {
       const bool has_mass = is<FreePosition>(s.motion.position) && !handle_moves_tool(s.device);
       if (has_mass || !s.rendering.force_stage) return false;
       const auto* limited = std::get_if<ActuatorLimitedPassivityConfig>(&*s.rendering.force_stage);
       return limited != nullptr && !limited->max_damping;
     }},
};

void check_drag_hand(const Scenario& scenario, double steps) {
  const auto* hand = std::get_if<DragHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  if (hand->direction) require_direction(*hand->direction, "/hand/direction");
  const double entries = drag_length(*hand, steps * scenario.time.step) / SurfacePath::spacing(hand->smoothing);
  if (entries <= kLongestDrag) return;
  fail_at("/hand/smoothing_m",
          fmt::format("got a path of {:.3g} times the tenth of it; allowed: at most {:.0g}", entries, kLongestDrag));
}

void check_tracking_hand(const Scenario& scenario, double steps) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  for (std::size_t i = 0; i < hand->subjects.size(); ++i)
    require_at_most(kMostDelaySamples, hand->subjects[i].reaction_delay / scenario.time.step,
                    fmt::format("/hand/subjects/{}/reaction_delay_s", i), "time steps");
  require_at_most(kMostSteps, trial_count(scenario.hand) * steps, "/hand/trials", "steps in all trials");
}

/// Throws InputError for fields that contradict each other. `steps` may be more than a scenario can hold.
void check_relations(const Scenario& scenario, double steps) {
  check_sizes(scenario, steps);
  check_orientation(scenario.motion);
  for (const Rule& rule : kRules) {
    if (rule.is_broken(scenario))
      fail_at(rule.at, fmt::format(fmt::runtime(rule.problem), scenario.rendering.contact_source));
  }
  check_drag_hand(scenario, steps);
  check_tracking_hand(scenario, steps);
}

constexpr const char* kNoEffect = "no_effect";  ///< of warnings: a given value that nothing reads

/// Warnings about values in `json` that the scenario does not have, because the algorithm's definition fixes others,
/// and about contacts that the algorithm does not have by its definition.
void warn_of_fixed_stages(const Scenario& scenario, const Json& json, std::vector<Warning>& warnings) {
  const RenderingConfig& fixed = scenario.rendering;
  const AlgorithmEntry& entry = *find_algorithm(fixed.algorithm);
  const std::string depth_model = json.value("rendering", Json::object()).value("depth_model", fixed.depth_model);
  if (!is<SpringsEnvironment>(scenario.environment) && depth_model != fixed.depth_model) {
    warnings.push_back({kNoEffect, "/rendering/depth_model",
                        fmt::format("\"{}\" is not used: algorithm \"{}\" is defined with \"{}\"", depth_model,
                                    fixed.algorithm, fixed.depth_model)});
  }
  if (has_other_contacts(scenario) && !entry.reported_depth_model.empty()) {
    warnings.push_back({kNoEffect, "/rendering/contact_source",
                        fmt::format("not used: algorithm \"{}\" finds its points itself", fixed.algorithm)});
  } else if (has_other_contacts(scenario) && !entry.fixed_depth_model.empty()) {
    warnings.push_back(
        {"other_depths", "/rendering/contact_source",
         fmt::format("algorithm \"{}\" is defined with depth model \"{}\"; here it has the depths of \"{}\"",
                     fixed.algorithm, entry.fixed_depth_model, fixed.contact_source)});
  }
  const Json::json_pointer reduction("/rendering/reduction");
  if (!fixed.reduction && json.contains(reduction) && !json.at(reduction).is_null()) {
    warnings.push_back({kNoEffect, reduction.to_string(),
                        fmt::format("not used: algorithm \"{}\" is defined without", fixed.algorithm)});
  }
}

void warn_of_idle_integrator(const Scenario& scenario, std::vector<Warning>& warnings) {
  if (!handle_moves_tool(scenario.device) || scenario.integrator.type == IntegratorFields{}.type) return;
  warnings.push_back({kNoEffect, "/integrator/type",
                      fmt::format("\"{}\" is not used: device \"impedance\" moves the tool, without a virtual mass",
                                  scenario.integrator.type->info.name)});
}

/// A warning about an admittance device whose servo or mechanics differ from the usual ones under a hand that does not
/// feel the handle. Sensor and limiter have an effect under any hand, so a device that changes only these is fine.
void warn_of_idle_device(const Scenario& scenario, std::vector<Warning>& warnings) {
  const char* hand = is<NoHandFields>(scenario.hand)      ? "none"
                     : is<ForceHandFields>(scenario.hand) ? "force"
                     : is<PushHandFields>(scenario.hand)  ? "push"
                                                          : nullptr;
  const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  if (hand == nullptr || device == nullptr) return;
  const AdmittanceDeviceConfig usual;
  const bool changes_loop = device->servo != usual.servo || device->mechanics != usual.mechanics;
  if (!changes_loop && (device->sensor != usual.sensor || device->force_limit != usual.force_limit)) return;
  warnings.push_back(
      {kNoEffect, "/device",
       fmt::format(
           "servo and mechanics (lag, delay, structure) move the handle alone and have no effect on the tool and "
           "its force: hand.type \"{}\" does not feel the handle; \"impedance\", \"drag\" and \"tracking\" do",
           hand)});
}

/// True when the algorithm documents the field as one of its parameters.
bool reads(const AlgorithmEntry& algorithm, std::string_view field) {
  const auto is_field = [field](const ParameterInfo& info) { return info.parameter.field == field; };
  return std::ranges::any_of(algorithm.info->parameters, is_field);
}

/// Warnings about values in `json`, other than the defaults, that the rendering does not read: parameters of other
/// algorithms, and the filter of a velocity that nothing sees.
void warn_of_unread_rendering(const Scenario& scenario, const Json& json, std::vector<Warning>& warnings) {
  const AlgorithmEntry& own = *find_algorithm(scenario.rendering.algorithm);
  const Json initial = {{"rendering", written_object(RenderingConfig{})}};
  std::map<std::string, std::vector<std::string>> readers;  // pointer of a field -> algorithms
  for (const AlgorithmEntry& other : algorithms()) {
    for (const ParameterInfo& info : other.info->parameters) {
      if (reads(own, info.parameter.field)) continue;
      std::string pointer = "/" + std::string(info.parameter.field);
      std::replace(pointer.begin(), pointer.end(), '.', '/');
      readers[pointer].emplace_back(other.info->name);
    }
    if (&other == &own) continue;
    for (const OwnParameter& parameter : other.own_parameters)
      readers[fmt::format("/rendering/parameters/{}/{}", other.info->name, parameter.name)] = {other.info->name};
  }
  const auto is_given = [&](const std::string& pointer) {
    const Json::json_pointer at(pointer);
    return json.contains(at) && !(initial.contains(at) && initial.at(at) == json.at(at));
  };
  for (const auto& [pointer, names] : readers) {
    if (!is_given(pointer)) continue;
    warnings.push_back(
        {kNoEffect, pointer,
         fmt::format("has no effect on this algorithm; it is a parameter of {}", fmt::join(names, ", "))});
  }
  for (const char* pointer : {"/rendering/damping_ratio", "/rendering/damping_N_s_per_m"}) {
    if (scenario.rendering.hunt_crossley && is_given(pointer))
      warnings.push_back({kNoEffect, pointer, "has no effect together with rendering.damping"});
  }
  constexpr const char* kCutoff = "/rendering/angular_velocity_cutoff_Hz";
  if (is_given(kCutoff) && !scenario.rendering.angular_damping)
    warnings.push_back({kNoEffect, kCutoff, "has no effect without rendering.angular_damping"});
}

/// A warning where the integrator does not step the bristle of dry friction stably: the tool never comes to rest.
void warn_of_stiff_bristle(const Scenario& scenario, std::vector<Warning>& warnings) {
  const RenderingConfig& r = scenario.rendering;
  if (!r.dry_friction || handle_moves_tool(scenario.device)) return;
  const SpringDamper bristle = bristle_of(*r.dry_friction, r, scenario.time.step);
  if (bristle.is_stable()) return;
  warnings.push_back(
      {"stiff_bristle", "/rendering/friction",
       fmt::format("a tool that sticks will chatter: a bristle of {:.4g} N/m is too stiff for steps of {:.4g} s and a "
                   "mass of {:.4g} kg",
                   bristle.K, bristle.dt, r.mass)});
}

/// The first script within `json`, found at `at`, that a run of so long [s] does not play. The reader has checked it.
std::optional<Warning> first_unplayed(const Json& json, const std::string& at, double duration) {
  if (!json.is_object()) return std::nullopt;
  if (json.value("type", Json()) == "waypoints") {
    const Json& points = json.at("points");
    if (points.size() < 2 || points[points.size() - 2][0].get<double>() < duration) return std::nullopt;
    return Warning{"unplayed_script", at,
                   fmt::format("the script's last waypoint is at {:.6g} s, but the run ends at {:.6g} s; is "
                               "time.duration_s (or steps) right?",
                               points.back()[0].get<double>(), duration)};
  }
  for (const auto& field : json.items()) {
    if (auto found = first_unplayed(field.value(), at + "/" + field.key(), duration)) return found;
  }
  return std::nullopt;
}

}  // namespace

double drag_length(const DragHandFields& hand, double duration) {
  if (!hand.path) return hand.drag.speed * duration;
  double length = 0.0;
  for (std::size_t i = 1; i < hand.path->size(); ++i) length += ((*hand.path)[i] - (*hand.path)[i - 1]).norm();
  return length;
}

bool records_rows(const RecordFields& record) {
  return record.trajectory || !record.ratio_iterations.empty() || record.contacts || record.stiffness_tensor ||
         record.energy || record.ideal_trajectory || record.force_reference;
}

void require_direction(const Vec3& direction, const std::string& at) {
  if (direction.norm() >= kShortestDirection) return;
  fail_at(at, fmt::format("got [{}]; allowed: a direction that is not zero, length at least {}",
                          fmt::join(direction, ", "), kShortestDirection));
}

void require_at_most(double most, double count, const std::string& at, const char* what) {
  if (!(count <= most)) fail_at(at, fmt::format("got {:.3g} {}; allowed: at most {:.0g}", count, what, most));
}

std::vector<Warning> relation_warnings(const Scenario& scenario, const Json& json) {
  std::vector<Warning> warnings;
  warn_of_fixed_stages(scenario, json, warnings);
  warn_of_idle_integrator(scenario, warnings);
  warn_of_idle_device(scenario, warnings);
  warn_of_unread_rendering(scenario, json, warnings);
  warn_of_stiff_bristle(scenario, warnings);
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  for (const char* part : {"hand", "motion"}) {
    if (!json.contains(part)) continue;
    if (auto found = first_unplayed(json.at(part), fmt::format("/{}", part), duration)) warnings.push_back(*found);
  }
  return warnings;
}

// ---- The fields of a scenario. ----

namespace {

constexpr auto kMostStepsOrRows = static_cast<std::int64_t>(kMostSteps);

/// Returns the number of steps, which may be more than a scenario can hold.
double describe_time(Fields& f, TimeFields& time) {
  std::optional<double> duration;
  f.number("step_s", time.step, {0.0, 1.0, "s", true}, "time step", Presence::required);
  f.integer("steps", time.steps, {1, kMostStepsOrRows}, "number of steps (rows)", Presence::no_default);
  f.if_any("duration_s", duration, "instead of steps: duration_s / step_s, rounded", [](Fields& d, double& value) {
    d.number(value, {0.0, 1e9, "s", true});
  });
  f.list("stop_when", time.stop_when, {0, 2}, "end early: tip centre above height 0; axis in the horizontal plane",
         [](Fields& s, StopCondition& value) {
           s.choice(value, {"leaves_hole", "tool_horizontal"}, "stop condition");
         });
  f.exactly_one_of("steps", "duration_s");
  return duration ? std::round(*duration / time.step) : static_cast<double>(time.steps);
}

/// One outcome, or a list of them.
void describe_outcomes(Fields& f, std::vector<Outcome>& outcomes) {
  const std::vector<std::string> names = names_of(outcome_infos(), &OutcomeInfo::name);
  const auto outcome = [&names](Fields& o, Outcome& value) { o.choice(value, names, "outcome"); };
  f.one_or_list(
      outcomes.size() != 1,
      [&](Fields& one) {
        Outcome value = outcomes.empty() ? Outcome::completes : outcomes.front();
        outcome(one, value);
        if (one.reads()) outcomes = {value};
      },
      [&](Fields& several) {
        several.list(outcomes, {1, outcome_infos().size()}, outcome);
      });
}

/// Puts the thesis's parameters of the scene (Tables A.1, A.2, B.1) in place of the structs' own, those of springs.
void set_scene_defaults(Scenario& scenario) {
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return;
  RenderingConfig& rendering = scenario.rendering;
  rendering.mu_s = 5.0;
  rendering.mu_f = 10.0;
  if (std::holds_alternative<Hole2d>(scenario.environment)) {
    scenario.tool = CylinderFields{.length = 0.005, .tip = Tip::round};
  } else {
    scenario.motion.orientation->up = {0.0, 0.0, 1.0};
    rendering.mass = 0.1;
  }
}

}  // namespace

static void describe(Fields& f, InitialFields& initial) {
  f.vector3("position_m", initial.position, {-1000.0, 1000.0, "m"},
            "tip centre at t = 0; ignored when the motion prescribes it");
  f.vector3("velocity_m_per_s", initial.velocity, {-1e6, 1e6, "m/s"}, "velocity at t = 0");
}

static void describe(Fields& f, IntegratorFields& integrator) {
  std::string type = integrator.type->info.name;
  const auto names = names_of(kIntegrators, [](const IntegratorEntry* entry) { return entry->info.name; });
  f.choice("type", type, names, "integrator", "leapfrog is the thesis's; \"hapbench describe NAME\" explains each",
           Presence::required);
  if (f.reads()) integrator.type = *std::ranges::find(kIntegrators, type, [](auto* entry) { return entry->info.name; });
  f.number("tolerance_s", integrator.tolerance, {1e-15, 1.0, "s"},
           "of event: within which it finds the times of contact on and off; 1e-9 unless it is given",
           integrator.type == &kEvent ? Presence::no_default : Presence::left_out);
}

static void describe(Fields& f, DivergenceBounds& bounds) {
  f.number("position_m", bounds.position, {0.0, 1e9, "m", true},
           "a run whose tip centre is further from the origin has diverged");
  f.number("speed_m_per_s", bounds.speed, {0.0, 1e12, "m/s", true}, "a run whose tool is faster has diverged");
  f.number("force_N", bounds.force, {0.0, 1e15, "N", true}, "a run whose rendered force is larger has diverged");
}

static void describe(Fields& f, RecordFields& record) {
  f.boolean("trajectory", record.trajectory, "write trajectory.csv");
  f.integer("every", record.every, {1, kMostStepsOrRows}, "record each N-th step only");
  f.list("ratio_iterations", record.ratio_iterations, {0, 1000},
         "write ratios.csv after these numbers of shaping iterations", [](Fields& i, std::int64_t& value) {
           i.integer(value, {0, 100'000});
         });
  f.boolean("contacts", record.contacts, "write contacts.csv");
  f.boolean("stiffness_tensor", record.stiffness_tensor, "write stiffness_tensor.csv");
  f.boolean("timing", record.timing, "time every step and write timing.json");
  f.boolean("energy", record.energy, "keep the energy ledger and write energy.csv");
  f.boolean("ideal_trajectory", record.ideal_trajectory,
            "block_with_hole only: compare the recorded rows with the ideal trajectory and write ideal_trajectory.csv");
  f.boolean("force_reference", record.force_reference,
            "with reference_force, or a stroke with a measured force: write it and the error into force_reference.csv");
  for (const TrajectoryGroup& group : trajectory_groups())
    f.boolean(group.field, record.*group.is_wanted, group.effect);
}

static void describe(Fields& f, SettlingRule& metrics) {
  f.number("from_s", metrics.from, {0.0, 1e9, "s"},
           "rows in contact from here on are settled, all before are landing; null: a landing is what follows a first "
           "touch");
  f.number("settling_s", metrics.time, {0.0, 1e9, "s"},
           "how long a landing lasts, and how long the tool must be away for the next touch to be a first one");
}

static void describe(Fields& f, MetricBound& bound) {
  const auto number = [](Fields& b, double& value) { b.number(value, {-1e15, 1e15}); };
  f.if_any("min", bound.min, "smallest value allowed", number);
  f.if_any("max", bound.max, "largest value allowed", number);
  if (!f.reads() || !bound.min || !bound.max || !(*bound.min > *bound.max)) return;
  fail_at(f.at(), fmt::format("got min {} above max {}; allowed: min <= max", *bound.min, *bound.max));
}

static void describe(Fields& f, ReferenceForceFields& reference) {
  profiles(f, {"x_N", "y_N", "z_N"}, reference.force, "N", "force on the tool over time");
}

static void describe(Fields& f, ExpectFields& expect) {
  f.field("outcome", "how the run must end, or a list of ways", Presence::has_default,
          [&expect](Fields& value) { describe_outcomes(value, expect.outcomes); });
  f.group("metrics", "bounds on the run's metrics, min and max of each; \"hapbench describe metrics\" shows them",
          Presence::has_default, [&expect](Fields& metrics) {
            for (const Metric& metric : all_metrics()) {
              const auto known = expect.metrics.find(metric.name);
              std::optional<MetricBound> bound;
              if (known != expect.metrics.end()) bound = known->second;
              metrics.if_any(metric.name, bound, metric.meaning, [](Fields& b, MetricBound& limits) {
                b.shared("metric_bound", [&limits](Fields& s) { s.object(limits); });
              });
              if (bound) expect.metrics[metric.name] = *bound;
            }
          });
}

/// Reading a file has already replaced this field by the fields of the scenario that it names.
static void describe_extends(Fields& f) {
  std::string other;
  f.text(kExtends, other, 4096,
         "another scenario, a file or a bundled name, over whose fields (but name and expect) these are merged; "
         "null replaces; so does an object of another type",
         Presence::left_out);
  if (!f.reads() || !f.given(kExtends)) return;
  fail_at(member(f.at(), kExtends), "got it in no file; allowed: in files");
}

void describe(Fields& f, Scenario& scenario) {
  double steps = 0.0;
  f.ignored("$schema", "the JSON Schema, for editors");
  describe_extends(f);
  f.text("name", scenario.name, 200, "default: the file's name");
  f.text("description", scenario.description, 10'000, "what it shows");
  f.text("source", scenario.source, 1000, "where the numbers come from");
  f.integer("seed", scenario.seed, {0, std::int64_t{1} << 53}, "of everything random");
  f.group("time", "time steps", Presence::required, [&](Fields& time) { steps = describe_time(time, scenario.time); });
  f.value("environment", scenario.environment, "what the tool touches", Presence::required);
  if (f.reads()) set_scene_defaults(scenario);
  f.object("initial", scenario.initial, "state at t = 0");
  f.value("tool", scenario.tool, "the tool; without a type it is a cylinder");
  f.object("motion", scenario.motion, "scripted motion");
  f.value("hand", scenario.hand, "who holds the handle");
  f.value("device", scenario.device, "the haptic device");
  f.object("rendering", scenario.rendering, "how contacts become a force");
  f.object("integrator", scenario.integrator, "how forces become motion");
  f.object("bounds", scenario.bounds, "where a run counts as diverged");
  f.object_if_any(
      "reference_force", scenario.reference_force,
      "the force an ideal rendering would give on a prescribed way; the metrics of fidelity are taken against it");
  f.object("record", scenario.record, "what is written besides the summary");
  f.object("metrics", scenario.metrics, "where metrics of settled contact begin");
  f.object("expect", scenario.expect, "what the run must show; each scenario is its own regression test");
  if (!f.reads()) return;
  resolve_delay(scenario);
  check_relations(scenario, steps);
  scenario.time.steps = static_cast<std::int64_t>(steps);
  scenario.rendering = with_fixed_stages(scenario.rendering);
}

}  // namespace hapbench
