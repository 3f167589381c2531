#include "scenarios/run/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/drag_hand.hpp"
#include "device_model/hands/impedance_hand.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/hands/tracking_hand.hpp"
#include "device_model/ideal_device.hpp"
#include "device_model/impedance_device.hpp"
#include "scenarios/run/peer_contacts.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {
namespace {

SpringSet make_springs(const SpringsEnvironment& fields, std::uint64_t seed) {
  SpringSet springs;
  springs.bilateral = fields.bilateral;
  springs.signed_depths = fields.signed_depths;
  for (const SpringGroup& group : fields.groups) {
    const double length = group.direction.norm();
    // Unit to rounding is left alone: dividing would change last digits.
    const Vec3 unit = std::abs(length - 1.0) <= 1e-12 ? group.direction : Vec3(group.direction / length);
    springs.gradients.insert(springs.gradients.end(), static_cast<std::size_t>(group.count), unit);
  }
  Random random(seed);
  for (std::int64_t i = 0; i < fields.random.count; ++i) {
    springs.gradients.push_back(fields.random.planar ? random.direction_in_plane() : random.direction());
  }
  return springs;
}

Orientation make_orientation(const OrientationFields& fields) {
  return {fields.up.normalized(), fields.lean.normalized(), fields.tilt, fields.azimuth, fields.roll};
}

std::unique_ptr<Motion> make_motion(const Scenario& scenario, const NamedFiles& files) {
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position))
    return std::make_unique<RecordedMotion>(files.at(kMotionFile).stroke()->motion);
  std::optional<std::array<Profile, 3>> position;
  if (const auto* prescribed = std::get_if<PrescribedPosition>(&scenario.motion.position)) {
    position = prescribed->coordinates;
  }
  return std::make_unique<ScriptedMotion>(make_orientation(*scenario.motion.orientation), std::move(position));
}

/// A seed of its own for each use of randomness in each trial: far apart in the 64 bits, whatever the scenario's seed.
std::uint64_t derived_seed(const Scenario& scenario, Trial trial, std::uint64_t use) {
  std::uint64_t seed = static_cast<std::uint64_t>(scenario.seed);
  for (const std::uint64_t part : {use, std::uint64_t{trial.subject}, std::uint64_t{trial.number}}) {
    seed = Random::derive(seed ^ (seed >> 29), part);
  }
  return seed;
}

constexpr std::uint64_t kSensorNoise = 1, kMotorNoise = 2, kTargetOrder = 3;

std::unique_ptr<TrackingHand> make_tracking_hand(const Scenario& scenario, const TrackingHandFields& fields,
                                                 Trial trial) {
  // The same subject gets the same order of targets with every algorithm, as the scenario's seed is the same.
  return std::make_unique<TrackingHand>(
      fields.subjects[trial.subject], TargetTask(fields.task, derived_seed(scenario, trial, kTargetOrder)),
      scenario.motion.orientation->tilt(0.0), scenario.time.step, derived_seed(scenario, trial, kMotorNoise));
}

/// Precondition: the shell is there.
void add_drag(const Scenario& scenario, const DragHandFields& fields, const NamedFiles& files, SimulationParts& parts) {
  const SmoothedSurface surface(*parts.shell, fields.smoothing);
  const double length = fields.drag.speed * static_cast<double>(scenario.time.steps) * scenario.time.step;
  const auto path = std::make_shared<const SurfacePath>(
      fields.path ? SurfacePath::over(surface, *fields.path)
                  : SurfacePath::along(surface, scenario.initial.position, *fields.direction, length));
  parts.hand = std::make_unique<DragHand>(fields.drag, path);
  if (fields.tilt) {
    parts.motion = std::make_unique<DragOrientation>(path, fields.drag.speed, *fields.tilt, fields.azimuth);
  } else {
    parts.motion = make_motion(scenario, files);
  }
}

/// The hand, and the motion, which some hands steer.
void add_hand_and_motion(const Scenario& scenario, const NamedFiles& files, Trial trial, SimulationParts& parts) {
  if (const auto* fields = std::get_if<TrackingHandFields>(&scenario.hand)) {
    auto hand = make_tracking_hand(scenario, *fields, trial);
    if (fields->task.display == TargetDisplay::height) {
      parts.motion = std::make_unique<HeldOrientation>(make_orientation(*scenario.motion.orientation), *hand);
    } else {
      parts.motion = make_motion(scenario, files);
    }
    parts.hand = std::move(hand);
    return;
  }
  if (const auto* drag = std::get_if<DragHandFields>(&scenario.hand)) return add_drag(scenario, *drag, files, parts);
  parts.motion = make_motion(scenario, files);
  if (const auto* force = std::get_if<ForceHandFields>(&scenario.hand)) {
    parts.hand = std::make_unique<ForceHand>(force->force);
  } else if (const auto* push = std::get_if<PushHandFields>(&scenario.hand)) {
    parts.hand = std::make_unique<PushHand>(push->force, push_direction(push->angle, push->azimuth));
  } else if (const ImpedanceHandFields* spring = spring_of(scenario.hand)) {
    parts.hand = std::make_unique<ImpedanceHand>(spring->stiffness, spring->damping, spring->target);
  } else {
    parts.hand = std::make_unique<NoHand>();
  }
}

/// What a hand does between its samples: nothing, unless it is fixed to the handle.
AttachedHand attached_hand(const HandFields& hand) {
  const auto* fields = std::get_if<MassSpringDamperHandFields>(&hand);
  return fields == nullptr ? AttachedHand{}
                           : AttachedHand{fields->mass, fields->spring.stiffness, fields->spring.damping};
}

std::unique_ptr<Device> make_device(const Scenario& scenario, Trial trial) {
  if (const auto* ideal = std::get_if<IdealDeviceFields>(&scenario.device)) {
    return std::make_unique<IdealDevice>(ideal->force_limit);
  }
  if (const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    return std::make_unique<ImpedanceDevice>(*impedance, scenario.time.step, attached_hand(scenario.hand));
  }
  AdmittanceDeviceConfig config = std::get<AdmittanceDeviceConfig>(scenario.device);
  if (scenario.motion.orientation) config.sensor.down = -scenario.motion.orientation->up.normalized();
  config.sensor.seed = derived_seed(scenario, trial, kSensorNoise);
  return std::make_unique<AdmittanceDevice>(config);
}

/// In one order whatever the scenario's is, since the first that holds gives the run its outcome.
std::vector<StopRule> stop_rules(const Scenario& scenario) {
  const auto& wanted = scenario.time.stop_when;
  const auto wants = [&wanted](StopCondition c) { return std::find(wanted.begin(), wanted.end(), c) != wanted.end(); };
  const Vec3 up = scenario.motion.orientation ? scenario.motion.orientation->up.normalized() : Vec3(0.0, 0.0, 1.0);
  std::vector<StopRule> rules;
  if (wants(StopCondition::leaves_hole)) rules.push_back(when_tool_leaves_hole(up));
  if (wants(StopCondition::tool_horizontal)) rules.push_back(when_tool_is_horizontal(up));
  return rules;
}

}  // namespace

std::vector<std::string> named_file_warnings(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  std::vector<std::string> warnings;
  for (const auto& file : loaded.files.all()) {
    for (const std::string& warning : file->warnings())
      warnings.push_back(fmt::format("{}: {}", file->pointer(), warning));
  }
  if (NamedFile* file = loaded.files.find(kMotionFile)) {
    const auto recorded = file->stroke();
    const auto stroke = recorded->motion.samples();
    const double start = stroke.front().time, stop = stroke.back().time;
    const double end = scenario.time.step * static_cast<double>(scenario.time.steps - 1);
    if (start > end || stop < 0.0) {
      warnings.push_back(
          fmt::format("{}: the stroke's clock runs from {:.6g} to {:.6g} s and the run's from 0 to {:.6g} s: the tool "
                      "stays at the {} sample; let the stroke begin at 0 or adapt time",
                      kMotionFile, start, stop, end, start > end ? "first" : "last"));
    }
  }
  return warnings;
}

std::vector<std::string> check_named_files(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  with_file(loaded, [&] { require_contact_source(scenario); });
  for (const auto& file : loaded.files.all()) {
    try {
      file->check();
      if (file->pointer() == kToolFile) make_tool(scenario, loaded.files);  // it must be closed, too
    } catch (const InputError& error) {
      const std::string place = file_of(loaded, file->pointer()).string() + ": " + file->pointer();
      throw InputError(InputError::Kind::relation, place, error.what());
    }
  }
  if (NamedFile* file = loaded.files.find(kMotionFile);
      file != nullptr && scenario.record.force_reference && !scenario.reference_force && !file->stroke()->force) {
    throw InputError(
        InputError::Kind::relation, file_of(loaded, "/record/force_reference").string() + ": /record/force_reference",
        fmt::format("got true; allowed: false, because {} has no columns mfx_N,mfy_N,mfz_N", file->path().string()));
  }
  std::vector<std::string> warnings = named_file_warnings(loaded);
  for (std::string& warning : warnings) {
    const std::string pointer = warning.substr(0, warning.find(": "));
    warning = file_of(loaded, pointer).string() + ": " + warning;
  }
  return warnings;
}

SimulationConfig simulation_config(const Scenario& scenario) {
  SimulationConfig config;
  config.skips = scenario.rendering.skips;
  config.dt = scenario.time.step;
  config.steps = static_cast<std::uint64_t>(scenario.time.steps);
  config.mass = scenario.rendering.mass;
  config.integrator = scenario.integrator.type;
  config.position = scenario.initial.position;
  config.velocity = scenario.initial.velocity;
  config.stop_when = stop_rules(scenario);
  config.bounds = scenario.bounds;
  return config;
}

SimulationParts assemble(const Scenario& scenario, const NamedFiles& files, std::shared_ptr<const PointShell> shell,
                         Trial trial) {
  SimulationParts parts;
  parts.tool = make_tool(scenario, files);
  parts.shell = std::move(shell);
  const RenderingConfig& rendering = scenario.rendering;
  if (const auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment)) {
    const auto seed = static_cast<std::uint64_t>(scenario.seed);
    parts.springs = std::make_shared<const SpringSet>(make_springs(*springs, seed));
    parts.source = std::make_unique<SpringSource>(parts.springs);
  } else if (rendering.contact_source != kOwnContacts) {
    parts.source = make_peer_source(scenario, files);
  } else {
    auto search = make_contact_query(*parts.shell, *parts.tool, rendering.skips);
    parts.source = std::make_unique<ShellSource>(*parts.shell, *parts.tool, std::move(search),
                                                 make_depth_model(rendering), rendering.skips);
  }
  parts.algorithm = make_algorithm(rendering);
  add_hand_and_motion(scenario, files, trial, parts);
  parts.device = make_device(scenario, trial);
  return parts;
}

SimulationParts assemble(const Scenario& scenario, std::shared_ptr<const PointShell> shell, Trial trial) {
  return assemble(scenario, NamedFiles(scenario), std::move(shell), trial);
}

SimulationParts assemble(const Scenario& scenario) {
  const NamedFiles files(scenario);
  return assemble(scenario, files, make_shell(scenario, files), {});
}

}  // namespace hapbench
