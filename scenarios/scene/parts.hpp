#pragma once

#include <memory>

#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"

/// The parts of a scenario: descriptions of their fields with meaning, unit, range and default, and factories of what
/// they say, side by side in environments.cpp, tools.cpp, hands.cpp and devices.cpp. Factories throw InputError when a
/// named file cannot be used. `files` are those of the scenario; make_shell without them reads them.
namespace hapbench {

/// Range of the lengths in a scene.
inline constexpr NumberRange kLength = {0.0, 1000.0, "m", true};
/// Throws InputError at `at` when the direction is shorter than 1e-12.
void require_direction(const Vec3& direction, const std::string& at);
/// Throws InputError at `at` when the count of `what` is larger.
void require_at_most(double most, double count, const std::string& at, const char* what);

// Objects.
void describe(Fields& f, Scenario& scenario);
void describe(Fields& f, MotionFields& motion);
void describe(Fields& f, RenderingConfig& rendering);

// Objects whose type chooses the fields.
void describe(Fields& f, Environment& environment);
void describe(Fields& f, HandFields& hand);
void describe(Fields& f, DeviceFields& device);
void describe(Fields& f, ToolFields& tool);

/// Three fields that hold functions of time with values in `unit`, which are x, y and z.
void profiles(Fields& f, const char* const (&names)[3], std::array<Profile, 3>& profiles, const char* unit,
              const char* doc, Presence presence = Presence::has_default);

/// Makes samples of a device's delay in seconds. Throws InputError where given samples say something else.
void resolve_delay(Scenario& scenario);

/// The types of tools, in the variant's order.
std::vector<std::string> tool_names();

/// Warnings about values without effect in `json`, from which the scenario was read, such as the first script of
/// waypoints of hand and motion whose last leg begins only when the run is over: a shorter time step with the same
/// number of steps does that unnoticed.
std::vector<Warning> relation_warnings(const Scenario& scenario, const Json& json);

/// One run of a scenario that has several: a simulated subject's trial. Both count from 0.
struct Trial {
  std::size_t subject = 0;
  std::size_t number = 0;
};

/// The uses of randomness that differ from trial to trial, by numbers on which seeds depend.
enum class RandomUse { sensor_noise = 1, motor_noise, target_order, position_noise, lost_queries, tremor };
/// A seed of its own for each use in each trial: far apart in the 64 bits, whatever the scenario's seed.
std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use);

/// The environment's points, as `validate --points` writes them; null for springs. Equal ones are shared (SharedCache).
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario, const NamedFiles& files);
inline std::shared_ptr<const PointShell> make_shell(const Scenario& scenario) {
  return make_shell(scenario, NamedFiles(scenario));
}

/// The inside of the environment's true surface, not of its shell; null for springs. Equal ones are shared.
std::shared_ptr<const Solid> make_solid(const Scenario& scenario, const NamedFiles& files);

Orientation make_orientation(const OrientationFields& fields);
/// The springs, those with random directions from the seed. Precondition: the environment is springs.
SpringSet make_springs(const Scenario& scenario);

/// The tool. The grid of a mesh takes seconds to make; equal ones are shared (SharedCache).
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files);
/// The tool, for callers that need a cylinder. Throws InputError when it is none.
Cylinder make_cylinder(const ToolFields& fields);

/// Adds the hand and the motion, which some hands steer. Precondition: the shell is there.
void add_hand_and_motion(const Scenario& scenario, const NamedFiles& files, Trial trial, SimulationParts& parts);

std::unique_ptr<Device> make_device(const Scenario& scenario, Trial trial);

}  // namespace hapbench
