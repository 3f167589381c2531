#pragma once

#include <memory>

#include "scenarios/format/named_files.hpp"
#include "scenarios/format/scenario.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"

/// Factories of the parts of a run. Each stands beside the description of its fields, in environments.cpp, tools.cpp,
/// motions.cpp, hands.cpp and devices.cpp. All throw InputError when a named file cannot be used. `files` are those of
/// the scenario; functions without `files` read them.
namespace hapbench {

/// One run of a scenario that has several: a simulated subject's trial. Both count from 0.
struct Trial {
  std::size_t subject = 0;
  std::size_t number = 0;
};

/// The uses of randomness that differ from trial to trial.
enum class RandomUse : std::uint64_t {
  sensor_noise = 1,
  motor_noise = 2,
  target_order = 3,
  position_noise = 4,
  lost_queries = 5,
  tremor = 6
};
/// A seed of its own for each use in each trial: far apart in the 64 bits, whatever the scenario's seed.
std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use);

/// The point shell of the scenario's environment, as `hapbench validate --points` writes it; null for springs.
/// Equal environments share one (SharedCache).
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario, const NamedFiles& files);
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario);

/// The inside of the scenario's environment, of its true surface and not of the shell; null for springs. Equal
/// environments share one (SharedCache).
std::shared_ptr<const Solid> make_solid(const Scenario& scenario, const NamedFiles& files);

/// The springs, those with random directions from the seed. Precondition: the environment is springs.
SpringSet make_springs(const Scenario& scenario);

/// The tool. The grid of a mesh takes seconds to make; equal ones are shared (SharedCache).
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files);
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario);
/// The tool, for callers that need a cylinder. Throws InputError when it is none.
Cylinder make_cylinder(const ToolFields& fields);

Orientation make_orientation(const OrientationFields& fields);
std::unique_ptr<Motion> make_motion(const Scenario& scenario, const NamedFiles& files);

/// Adds the hand and the motion, which some hands steer. Precondition: the shell is there.
void add_hand_and_motion(const Scenario& scenario, const NamedFiles& files, Trial trial, SimulationParts& parts);

std::unique_ptr<Device> make_device(const Scenario& scenario, Trial trial);

}  // namespace hapbench
