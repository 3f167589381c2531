// The simulation engine of a web page: a scenario whose hand and wrist follow a mouse pointer, step by step.
// One WebAssembly instance simulates one run. Exported functions take and return numbers and addresses in the
// instance's memory; texts end with a zero byte. An exception ends the instance (runtime.cpp).
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "device_model/hands/scripted_hands.hpp"
#include "results/observe/contact_forces.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/motions.hpp"
#include "sim/core/hash.hpp"
#include "sim/loop/simulation.hpp"

#define EXPORTED(name) __attribute__((export_name(#name)))

namespace hapbench {
namespace {

/// Waypoints of the pointer, which sets the hand's target position [m] and the wrist's tilt and azimuth [rad]. Keeps
/// only the latest waypoints. In the next step and in all later steps, a profile of the kept waypoints has the same
/// values, bit for bit, as a profile of all waypoints.
class Pointer {
 public:
  static constexpr std::size_t kLed = 5;

  /// Adds a waypoint at time t [s]. `now` is the time of the next step [s]. Of the waypoints up to the time `now`, only
  /// the last two are kept.
  void add(double t, const std::array<double, kLed>& values, double now) {
    for (std::size_t i = 0; i < kLed; ++i) {
      auto& points = led_[i].points;
      while (points.size() > 2 && points[2].first <= now) points.erase(points.begin());
      points.push_back({t, values[i]});
    }
  }
  Profile profile(std::size_t i) const { return Profile::Shape(led_[i]); }
  std::array<Profile, 3> position() const { return {profile(0), profile(1), profile(2)}; }

 private:
  std::array<Profile::Waypoints, kLed> led_;
};

nlohmann::json list(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Number of values in the row of a step: time, five vectors, largest depth, number of contacts. ROW in page/engine.js
/// lists their indices.
constexpr std::size_t kRowNumbers = 1 + 5 * 3 + 2;

/// One run of a page, with the values that the page shows.
class Session final : public Observer {
 public:
  /// Prepares the run. `is_led`: the pointer moves the hand, and aim() must be called before the first step.
  /// Otherwise the scenario's hand and motion act, and the run begins at once.
  Session(LoadedScenario loaded, bool is_led) : scene_(checked(std::move(loaded))) {
    if (is_led)
      attach_pointer();
    else
      begin();
  }

  void on_step(const StepRecord& row) noexcept override {
    last_ = row.force.S;
    // Part of the force above the cutoff frequency of vibration; zero if the sampling rate is too low for the filter.
    Vec3 vibration = Vec3::Zero();
    if (high_pass_) {
      if (row.step == 0) high_pass_->settle_at(row.force.rendered);
      vibration = high_pass_->filter(row.force.rendered);
    }
    contacts_.assign(*row.rendered);
    // Append the numbers of the step (kRowNumbers).
    rows_.push_back(row.time);
    for (const Vec3& v : {row.tool.pose.position, row.tool.pose.axis, row.force.rendered, row.force.spring, vibration})
      rows_.insert(rows_.end(), {v.x(), v.y(), v.z()});
    rows_.insert(rows_.end(), {row.force.depth_max, static_cast<double>(row.rendered->size())});
  }

  /// Adds a waypoint, which the hand's target and the wrist reach at time t [s]. The first waypoint starts the run.
  void aim(double t, const std::array<double, Pointer::kLed>& values) {
    const std::uint64_t row = simulation_ ? simulation_->next_row() : 0;
    const Scenario& scenario = scene_.scenario();
    pointer_.add(t, values, static_cast<double>(row) * scenario.time.step);
    const auto& hand = std::get<ImpedanceHandFields>(scenario.hand);
    *hand_ = ImpedanceHand(hand.stiffness, hand.damping, pointer_.position());
    Orientation led = make_orientation(*scenario.motion.orientation);
    led.tilt = pointer_.profile(3);
    led.azimuth = pointer_.profile(4);
    *motion_ = ScriptedMotion(led, std::nullopt);
    if (!simulation_) begin();
  }

  /// Simulates at most `rows` steps. Returns their rows, kRowNumbers values each, valid until the next call.
  const double* advance(std::uint32_t rows) {
    rows_.clear();
    rows_.reserve(kRowNumbers * rows);
    simulation_->advance(rows);
    return rows_.data();
  }
  /// Returns the number of steps of the last advance().
  std::size_t advanced() const { return rows_.size() / kRowNumbers; }

  const char* text(const nlohmann::json& json) {
    text_ = json.dump();
    return text_.c_str();
  }

  /// Returns the data of the scene that are constant during the run, as JSON.
  const char* scene() {
    const Scenario& scenario = scene_.scenario();
    nlohmann::json outline = nlohmann::json::array();
    if (tool_) {
      for (const ProfilePoint& p : tool_->outline()) outline.push_back({p.s, p.rho});
    }
    const OrientationFields turned = scenario.motion.orientation.value_or(OrientationFields());
    const Box box = shell_ ? shell_->bounds() : Box{};
    return text({{"step_s", scenario.time.step},
                 {"stiffness_N_per_m", scenario.rendering.stiffness},
                 {"algorithm", scenario.rendering.algorithm},
                 {"initial_m", list(scenario.initial.position)},
                 {"tilt_rad", turned.tilt(0.0)},
                 {"azimuth_rad", turned.azimuth(0.0)},
                 {"up", list(turned.up.normalized())},
                 {"lean", list(turned.lean.normalized())},
                 {"half_width_m", tool_ ? tool_->half_width() : 0.0},
                 {"outline_m", outline},
                 {"box_m", {list(box.min), list(box.max)}},
                 {"points", shell_ ? shell_->size() : 0}});
  }

  /// Returns the state hash and totals of the run so far, and the contacts and stiffness tensor of its last
  /// step, as JSON.
  const char* state() {
    nlohmann::json contacts = nlohmann::json::array();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const Vec3 p = contacts_.point(i), u = contacts_.gradient(i);
      contacts.push_back({p.x(), p.y(), p.z(), u.x(), u.y(), u.z(), contacts_.depth[i], contacts_.weight[i]});
    }
    nlohmann::json tensor = nlohmann::json::array();
    for (Eigen::Index i = 0; i < 3; ++i) tensor.push_back(list(last_.row(i).transpose()));
    const SimulationResult& result = simulation_->result();
    const bool diverged = result.ending == Ending::diverged;
    return text({{"rows", result.rows},
                 {"state_hash", hash_text(metrics_.state_hash())},
                 {"outcome", outcome_name(outcome_of(result.ending))},
                 {"fault", diverged ? result.divergence.quantity : ""},
                 {"energy_created_J", passivity_.net_created()},
                 {"tensor", tensor},
                 {"contacts", contacts}});
  }

  const PointShell* shell() const { return shell_.get(); }

 private:
  /// Lets the pointer control the hand's target and the wrist. Throws InputError if the scenario has another hand or a
  /// scripted position.
  void attach_pointer() {
    const Scenario& scenario = scene_.scenario();
    if (!std::holds_alternative<ImpedanceHandFields>(scenario.hand))
      throw InputError("/hand/type: allowed: \"impedance\", whose target the pointer leads");
    if (!scenario.motion.orientation || !position_is_free(scenario.motion))
      throw InputError("/motion/position/type: allowed: \"free\", because the pointer leads the tool");
    // assemble() makes these types from the fields that were checked above.
    hand_ = static_cast<ImpedanceHand*>(parts_.hand.get());
    motion_ = static_cast<ScriptedMotion*>(parts_.motion.get());
  }

  void begin() {
    simulation_.emplace(simulation_config(scene_.scenario()), std::move(parts_),
                        std::vector<Observer*>{&metrics_, &passivity_, this});
  }

  CheckedScenario scene_;
  SimulationParts parts_ =
      assemble(scene_.scenario(), scene_.files(), make_shell(scene_.scenario(), scene_.files()), {});
  std::shared_ptr<const PointShell> shell_ = parts_.shell;
  std::shared_ptr<const ToolShape> tool_ = parts_.tool;
  ImpedanceHand* hand_ = nullptr;     ///< owned by the simulation; null if the pointer does not move the hand
  ScriptedMotion* motion_ = nullptr;  ///< owned by the simulation; null if the pointer does not move the hand
  Pointer pointer_;
  MetricsObserver metrics_{scene_.scenario().time.step};
  PassivityObserver passivity_{scene_.scenario().time.step};
  std::optional<HighPass> high_pass_ = vibration_filter(scene_.scenario().time.step);
  ContactBuffer contacts_{parts_.source->capacity()};
  std::optional<Simulation> simulation_;
  Mat3 last_ = Mat3::Zero();
  std::vector<double> rows_;
  std::string text_;
};

std::optional<Session> session;

[[noreturn]] void refuse_library() {
  throw InputError("a page loads no libraries; run this scenario with hapbench");
}

}  // namespace

// Replacements of engine parts that need an operating system: the folder of an installation, modules and
// signals.

/// Returns the path of a file of the page or of a bundled scenario. Throws InputError if neither exists.
std::filesystem::path find_scenario(const std::string& name, const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> places = {directory / name};
  for (const char* group : kScenarioGroups)
    places.push_back(std::filesystem::path("/scenarios") / group / (name + ".json"));
  for (const auto& file : places)
    if (std::error_code error; std::filesystem::exists(file, error)) return file;
  throw InputError(name + ": no such file and no bundled scenario");
}

void require_contacts_in(const std::filesystem::path&) {
  refuse_library();
}
void inspect_module(const std::filesystem::path&) {
  refuse_library();
}
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path&, const std::string&, const HapbenchRun&) {
  refuse_library();
}

void throw_if_stopped() {}

extern "C" {

EXPORTED(allocate) void* page_allocate(std::uint32_t size) {
  return std::malloc(size);
}

/// Creates the run of a file or bundled scenario. Each line of `overrides` has the form of a value of --set. `is_led`:
/// 1 if the pointer moves the hand, otherwise 0.
EXPORTED(load) void page_load(const char* name, const char* overrides, std::uint32_t is_led) {
  std::vector<std::string> given;
  LineReader lines(overrides);
  while (const auto line = lines.next()) given.emplace_back(*line);
  session.emplace(load_scenario(find_scenario(name), given), is_led != 0);
}

EXPORTED(scene) const char* page_scene() {
  return session->scene();
}

/// Adds a waypoint: the pointer reaches position x, y, z [m], tilt and azimuth [rad] at time t [s].
EXPORTED(aim) void page_aim(double t, double x, double y, double z, double tilt, double azimuth) {
  session->aim(t, {x, y, z, tilt, azimuth});
}

/// Simulates at most `rows` steps and returns their rows in sequence. Precondition if the pointer moves the hand: the
/// steps end at least two steps before the last waypoint.
EXPORTED(advance) const double* page_advance(std::uint32_t rows) {
  return session->advance(rows);
}
/// Returns the number of steps of the last `advance`. It is smaller than requested if the run has ended.
EXPORTED(advanced) std::uint32_t page_advanced() {
  return static_cast<std::uint32_t>(session->advanced());
}

EXPORTED(state) const char* page_state() {
  return session->state();
}

/// Returns one coordinate of all points of the point shell: x, y, z [m] for `which` = 0 to 2, components of the normals
/// for 3 to 5. Returns null without a shell.
EXPORTED(coordinates) const double* page_coordinates(std::uint32_t which) {
  const PointShell* shell = session->shell();
  if (shell == nullptr) return nullptr;
  const double* columns[] = {shell->x(), shell->y(), shell->z(), shell->nx(), shell->ny(), shell->nz()};
  return columns[which];
}

}  // extern "C"

}  // namespace hapbench
