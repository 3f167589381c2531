// The engine for a page: a scenario whose hand and wrist follow a pointer, row by row. One WebAssembly instance is one
// run. Exported functions take and return numbers and addresses in the instance's memory; texts end with a zero byte.
// An exception ends the instance (runtime.cpp).
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

/// The last waypoints of what a pointer leads: place [m], tilt and azimuth [rad]. Profiles of these few have, where
/// they lead, the values of profiles of all waypoints, bit for bit.
class Pointer {
 public:
  static constexpr std::size_t kLed = 5;

  /// `now`: time of the next row [s]; of the waypoints before it the last two stay.
  void add(double t, const std::array<double, kLed>& values, double now) {
    for (std::size_t i = 0; i < kLed; ++i) {
      auto& points = led_[i].points;
      while (points.size() > 2 && points[2].first <= now) points.erase(points.begin());
      points.push_back({t, values[i]});
    }
  }
  Profile profile(std::size_t i) const { return Profile::Shape(led_[i]); }
  std::array<Profile, 3> place() const { return {profile(0), profile(1), profile(2)}; }

 private:
  std::array<Profile::Waypoints, kLed> led_;
};

nlohmann::json list(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Numbers of a row for the page: time, five vectors, depth, number of contacts. ROW in page/engine.js has the places.
constexpr std::size_t kRowNumbers = 1 + 5 * 3 + 2;

class Session final : public Observer {
 public:
  /// If the pointer leads the run, call `aim` before the first row; if not, the scenario's own hand and motion do.
  Session(LoadedScenario loaded, bool is_led) : scene_(checked(std::move(loaded))) {
    if (is_led)
      put_on_pointer();
    else
      begin();
  }

  void on_step(const StepRecord& row) noexcept override {
    last_ = row.force.S;
    Vec3 vibration = Vec3::Zero();  // the force above the cutoff; zero where the sampling rate is too low for that
    if (high_pass_) {
      if (row.step == 0) high_pass_->settle_at(row.force.rendered);
      vibration = high_pass_->filter(row.force.rendered);
    }
    contacts_.assign(*row.rendered);
    rows_.push_back(row.time);
    for (const Vec3& v : {row.tool.pose.position, row.tool.pose.axis, row.force.rendered, row.force.spring, vibration})
      rows_.insert(rows_.end(), {v.x(), v.y(), v.z()});
    rows_.insert(rows_.end(), {row.force.depth_max, static_cast<double>(row.rendered->size())});
  }

  /// The pointer's waypoints from now on end with this one.
  void aim(double t, const std::array<double, Pointer::kLed>& values) {
    const std::uint64_t row = simulation_ ? simulation_->next_row() : 0;
    const Scenario& scenario = scene_.scenario();
    pointer_.add(t, values, static_cast<double>(row) * scenario.time.step);
    const auto& hand = std::get<ImpedanceHandFields>(scenario.hand);
    *hand_ = ImpedanceHand(hand.stiffness, hand.damping, pointer_.place());
    Orientation led = make_orientation(*scenario.motion.orientation);
    led.tilt = pointer_.profile(3);
    led.azimuth = pointer_.profile(4);
    *motion_ = ScriptedMotion(led, std::nullopt);
    if (!simulation_) begin();
  }

  const double* advance(std::uint32_t rows) {
    rows_.clear();
    rows_.reserve(kRowNumbers * rows);
    simulation_->advance(rows);
    return rows_.data();
  }
  std::size_t advanced() const { return rows_.size() / kRowNumbers; }

  const char* text(const nlohmann::json& json) {
    text_ = json.dump();
    return text_.c_str();
  }

  /// The data of the scene that stay the same during the run, as JSON.
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

  /// The state hash and totals of the run so far, and contacts and stiffness tensor of its last row, as JSON.
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
  void put_on_pointer() {
    const Scenario& scenario = scene_.scenario();
    if (!std::holds_alternative<ImpedanceHandFields>(scenario.hand))
      throw InputError("/hand/type: allowed: \"impedance\", whose target the pointer leads");
    if (!scenario.motion.orientation || !position_is_free(scenario.motion))
      throw InputError("/motion/position/type: allowed: \"free\", because the pointer leads the tool");
    // What is assembled of these fields.
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
  ImpedanceHand* hand_ = nullptr;     ///< the simulation's
  ScriptedMotion* motion_ = nullptr;  ///< the simulation's
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

// The parts of the engine that need an operating system: the folder of an installation, modules and signals.

/// A file of the page, or else a bundled scenario.
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
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path&, const std::string&, const HapbenchRun&) {
  refuse_library();
}

void throw_if_stopped() {}

extern "C" {

EXPORTED(allocate) void* page_allocate(std::uint32_t size) {
  return std::malloc(size);
}

/// Makes the run of a file or bundled scenario, perhaps led by the pointer; `overrides` are lines as for --set.
EXPORTED(load) void page_load(const char* name, const char* overrides, std::uint32_t is_led) {
  std::vector<std::string> given;
  LineReader lines(overrides);
  while (const auto line = lines.next()) given.emplace_back(*line);
  session.emplace(load_scenario(find_scenario(name), given), is_led != 0);
}

EXPORTED(scene) const char* page_scene() {
  return session->scene();
}

/// From its last waypoint on, the pointer moves to these values, which it reaches at time t [s, m, rad].
EXPORTED(aim) void page_aim(double t, double x, double y, double z, double tilt, double azimuth) {
  session->aim(t, {x, y, z, tilt, azimuth});
}

/// Computes so many rows, which must end two steps before the last waypoint, and returns their numbers, row after row.
EXPORTED(advance) const double* page_advance(std::uint32_t rows) {
  return session->advance(rows);
}
/// The number of rows of the last `advance`: fewer than asked for once the run has ended.
EXPORTED(advanced) std::uint32_t page_advanced() {
  return static_cast<std::uint32_t>(session->advanced());
}

EXPORTED(state) const char* page_state() {
  return session->state();
}

/// A coordinate of the shell's points, or of their normals for 3 ... 5; null without a shell.
EXPORTED(coordinates) const double* page_coordinates(std::uint32_t which) {
  const PointShell* shell = session->shell();
  if (shell == nullptr) return nullptr;
  const double* columns[] = {shell->x(), shell->y(), shell->z(), shell->nx(), shell->ny(), shell->nz()};
  return columns[which];
}

}  // extern "C"

}  // namespace hapbench
