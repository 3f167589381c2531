#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "scenarios/description/descriptions.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

/// Rules between the fields of a scenario, which a schema cannot express.
namespace hapbench {
namespace {

constexpr double kMostDelaySamples = 1e6;  ///< longest reaction delay of a simulated subject [time steps]
constexpr double kLongestDrag = 1e6;       ///< entries of the table of a path over a surface

[[noreturn]] void fail(const std::string& at, const std::string& problem) {
  throw InputError(InputError::Kind::relation, at, problem);
}

void check_sizes(const Scenario& scenario, double steps) {
  if (!(steps >= 1.0 && steps <= kMostSteps)) {
    fail("/time/duration_s",
         fmt::format("got {:.3g} steps (duration_s / step_s); allowed: 1 ... {:.0g}", steps, kMostSteps));
  }
  const double rows = steps / static_cast<double>(scenario.record.every);
  if (records_rows(scenario.record) && rows > kMostRows) {
    fail("/record/every",
         fmt::format("got {:.3g} recorded rows; allowed: at most {:.0g}, record less often or less", rows, kMostRows));
  }
  // Every step of every trial has its time in memory.
  const double timed = steps * trial_count(scenario.hand);
  if (scenario.record.timing && timed > kMostRows) {
    fail("/record/timing", fmt::format("got {:.3g} timed steps; allowed: at most {:.0g}", timed, kMostRows));
  }
}

void check_orientation(const MotionFields& motion) {
  if (!motion.orientation) return;
  const Vec3 &up = motion.orientation->up, &lean = motion.orientation->lean;
  // 1e-9 forgives the rounding of directions that were normalised by somebody else.
  if (up.norm() >= kShortestDirection && lean.norm() >= kShortestDirection &&
      std::abs(up.dot(lean)) <= 1e-9 * up.norm() * lean.norm())
    return;
  fail("/motion/orientation",
       fmt::format("got up {} and lean {}; allowed: two perpendicular directions, not zero", shown(up), shown(lean)));
}

void check_local_average(const Scenario& scenario) {
  if (!scenario.rendering.local_average) return;
  const auto* shell = std::get_if<PointShellEnvironment>(&scenario.environment);
  const auto* mesh = std::get_if<MeshEnvironment>(&scenario.environment);
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) {
    fail("/rendering/local_average", "got true; allowed: false, because springs have no grid cells");
  }
  if ((shell != nullptr && !shell->grid) || (mesh != nullptr && !mesh->grid)) {
    fail("/rendering/local_average", "got true; allowed: false, unless environment.grid_m gives the cells");
  }
}

/// A peer finds contacts between triangles and a cylinder; they have no shell points.
void check_contact_source(const Scenario& scenario) {
  const RenderingConfig& rendering = scenario.rendering;
  if (rendering.contact_source == kOwnContacts) return;
  const auto* drill = std::get_if<CylinderFields>(&scenario.tool);
  const bool is_solid = std::holds_alternative<BlockEnvironment>(scenario.environment) ||
                        std::holds_alternative<MeshEnvironment>(scenario.environment);
  const char* problem = !is_solid ? "unless the environment is a block_with_hole or a mesh"
                        : drill == nullptr || drill->tip != Tip::flat ? "unless the tool is a cylinder with a flat tip"
                        : rendering.local_average                     ? "with local_average, which merges shell points"
                        : rendering.reduction && rendering.reduction->shuffle_seed
                            ? "with reduction.shuffle_seed, which orders shell points"
                            : nullptr;
  if (problem == nullptr) return;
  fail("/rendering/contact_source",
       fmt::format("got \"{}\"; allowed: \"{}\", {}", rendering.contact_source, kOwnContacts, problem));
}

void check_ideal_trajectory(const Scenario& scenario) {
  if (!scenario.record.ideal_trajectory || has_ideal_trajectory(scenario)) return;
  fail("/record/ideal_trajectory",
       "got true; allowed: false, unless the environment is block_with_hole and the tool a cylinder with a flat tip");
}

void check_force_reference(const Scenario& scenario) {
  const bool is_free = std::holds_alternative<FreePosition>(scenario.motion.position);
  if (scenario.reference_force && is_free)
    fail("/reference_force",
         "contradicts motion.position of type \"free\"; allowed with a way that is known beforehand");
  if (!scenario.record.force_reference || scenario.reference_force ||
      std::holds_alternative<RecordedPosition>(scenario.motion.position))
    return;
  fail("/record/force_reference",
       "got true; allowed: false, unless there is a reference_force or motion.position is of type \"file\"");
}

void check_push_hand(const Scenario& scenario) {
  if (!std::holds_alternative<PushHandFields>(scenario.hand)) return;
  if (!std::holds_alternative<Hole2d>(scenario.environment)) return;
  fail("/hand/type", "got \"push\", which pushes along z; allowed in the plane of \"hole_2d\": \"force\"");
}

double drag_length(const DragHandFields& hand, double duration) {
  if (!hand.path) return hand.drag.speed * duration;
  double length = 0.0;
  for (std::size_t i = 1; i < hand.path->size(); ++i) length += ((*hand.path)[i] - (*hand.path)[i - 1]).norm();
  return length;
}

void check_drag_hand(const Scenario& scenario, double steps) {
  const auto* hand = std::get_if<DragHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment))
    fail("/hand/type", "got \"drag\" with springs, which have no surface; allowed: environments that have one");
  if (!std::holds_alternative<FreePosition>(scenario.motion.position)) {
    fail("/motion/position/type",
         "got a prescribed position; allowed: \"free\" with hand \"drag\", which moves the tool");
  }
  const auto is_zero = [](const Profile& profile) { return profile.is_constant() && profile(0.0) == 0.0; };
  const OrientationFields& orientation = *scenario.motion.orientation;
  if (hand->tilt && !(is_zero(orientation.tilt) && is_zero(orientation.azimuth) && is_zero(orientation.roll))) {
    fail(
        "/motion/orientation",
        "got tilt_rad, azimuth_rad or roll_rad beside hand \"drag\", which turns the tool; allowed: without, or hand.tilt_rad "
        "null");
  }
  if (hand->direction) require_direction(*hand->direction, "/hand/direction");
  const double entries = drag_length(*hand, steps * scenario.time.step) / SurfacePath::spacing(hand->smoothing);
  if (entries <= kLongestDrag) return;
  fail("/hand/smoothing_m",
       fmt::format("got a path of {:.3g} times the tenth of it; allowed: at most {:.0g}", entries, kLongestDrag));
}

void check_tracking_hand(const Scenario& scenario, double steps) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  if (!std::holds_alternative<FreePosition>(scenario.motion.position)) {
    fail("/motion/position/type",
         "got a prescribed position; allowed: \"free\" with hand \"tracking\", which moves the tool");
  }
  for (std::size_t i = 0; i < hand->subjects.size(); ++i) {
    const double samples = hand->subjects[i].reaction_delay / scenario.time.step;
    if (samples <= kMostDelaySamples) continue;
    fail(fmt::format("/hand/subjects/{}/reaction_delay_s", i),
         fmt::format("got {:.3g} time steps; allowed: at most {:.0g}", samples, kMostDelaySamples));
  }
  const double all_steps = trial_count(scenario.hand) * steps;
  if (all_steps <= kMostSteps) return;
  fail("/hand/trials", fmt::format("got {:.3g} steps in all trials; allowed: at most {:.0g}", all_steps, kMostSteps));
}

void check_perception(const Scenario& scenario) {
  if (!scenario.perception) return;
  const double from = scenario.perception->band_from, to = scenario.perception->band_to;
  if (from < to) return;
  fail("/perception/band_Hz", fmt::format("got from {:g} to {:g}; allowed: from below to", from, to));
}

/// Refuses what needs a virtual mass between hand and tool where the device has none.
void check_impedance_device(const Scenario& scenario) {
  const bool impedance = handle_moves_tool(scenario.device);
  if (!impedance && std::holds_alternative<MassSpringDamperHandFields>(scenario.hand)) {
    fail(
        "/hand/type",
        "got \"mass_spring_damper\", which is fixed to the handle of device \"impedance\"; allowed with other devices: "
        "\"impedance\", the same spring and damper without the mass");
  }
  if (!impedance) return;
  if (!std::holds_alternative<FreePosition>(scenario.motion.position)) {
    fail("/motion/position/type",
         "got a prescribed position; allowed: \"free\" with device \"impedance\", whose handle moves the tool");
  }
  if (scenario.rendering.passivity_controller) {
    fail("/rendering/passivity_controller",
         "got true; allowed: false with device \"impedance\": the controller looks ahead by the virtual mass, which is "
         "not there");
  }
}

/// A warning about an admittance device whose servo or mechanics differ from the usual ones under a hand that does not
/// feel the handle. Sensor and limiter have an effect under any hand, so a device that changes only these is fine.
void warn_of_idle_device(const Scenario& scenario, std::vector<std::string>& warnings) {
  const char* hand = std::holds_alternative<NoHandFields>(scenario.hand)      ? "none"
                     : std::holds_alternative<ForceHandFields>(scenario.hand) ? "force"
                     : std::holds_alternative<PushHandFields>(scenario.hand)  ? "push"
                                                                              : nullptr;
  const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  if (hand == nullptr || device == nullptr) return;
  const AdmittanceDeviceConfig usual;
  const bool changes_loop = device->servo != usual.servo || device->mechanics != usual.mechanics;
  if (!changes_loop && (device->sensor != usual.sensor || device->force_limit != usual.force_limit)) return;
  warnings.push_back(fmt::format(
      "/device: servo and mechanics (lag, delay, structure) move the handle alone and have no effect on the tool and its "
      "force: hand.type \"{}\" does not feel the handle; \"impedance\", \"drag\" and \"tracking\" do",
      hand));
}

/// The first script within `json`, found at `at`, that a run of so long [s] does not play. The reader has checked it.
std::optional<std::string> first_unplayed(const Json& json, const std::string& at, double duration) {
  if (!json.is_object()) return std::nullopt;
  if (json.value("type", Json()) == "waypoints") {
    const Json& points = json.at("points");
    if (points.size() < 2 || points[points.size() - 2][0].get<double>() < duration) return std::nullopt;
    return fmt::format(
        "{}: the script's last waypoint is at {:.6g} s, but the run ends at {:.6g} s; is time.duration_s (or steps) "
        "right?",
        at, points.back()[0].get<double>(), duration);
  }
  for (const auto& field : json.items()) {
    if (auto found = first_unplayed(field.value(), at + "/" + field.key(), duration)) return found;
  }
  return std::nullopt;
}

}  // namespace

void require_direction(const Vec3& direction, const std::string& at) {
  if (direction.norm() >= kShortestDirection) return;
  fail(at, fmt::format("got [{}, {}, {}]; allowed: a direction that is not zero, length at least {}", direction.x(),
                       direction.y(), direction.z(), kShortestDirection));
}

void check_relations(const Scenario& scenario, double steps) {
  check_sizes(scenario, steps);
  check_orientation(scenario.motion);
  check_local_average(scenario);
  check_contact_source(scenario);
  check_ideal_trajectory(scenario);
  check_force_reference(scenario);
  check_push_hand(scenario);
  check_drag_hand(scenario, steps);
  check_tracking_hand(scenario, steps);
  check_perception(scenario);
  check_impedance_device(scenario);
}

std::vector<std::string> relation_warnings(const Scenario& scenario, const Json& json) {
  std::vector<std::string> warnings;
  warn_of_idle_device(scenario, warnings);
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  for (const char* part : {"hand", "motion"}) {
    if (!json.contains(part)) continue;
    if (auto found = first_unplayed(json.at(part), fmt::format("/{}", part), duration)) warnings.push_back(*found);
  }
  return warnings;
}

}  // namespace hapbench
