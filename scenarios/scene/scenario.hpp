#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/drag_hand.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/hands/tracking_hand.hpp"
#include "device_model/impedance_device.hpp"
#include "results/observe/contact_forces.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/outcome.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "sim/tool/bur_profile.hpp"
#include "sim/tool/motion.hpp"

/// A scenario file as plain structs, with every default in place: a default-constructed scenario is that of springs.
/// The functions `describe` of this folder have names, units and ranges of the file's fields.
namespace hapbench {

/// Conditions that end a run early, with the outcome of the same name.
enum class StopCondition { leaves_hole, tool_horizontal };

struct TimeFields {
  double step = 0.0005;    ///< [s]
  std::int64_t steps = 1;  ///< rows
  std::vector<StopCondition> stop_when;
  /// Steps between rows that the metrics take in, so that finer steps are measured as often; not a field of the file.
  std::int64_t stride = 1;
};

struct SpringGroup {
  Vec3 direction = {1.0, 0.0, 0.0};  ///< gradient; normalised when the springs are made
  std::int64_t count = 1;
};
struct RandomSprings {
  std::int64_t count = 0;
  bool planar = true;
};
struct SpringsEnvironment {
  bool bilateral = true;
  bool signed_depths = true;
  std::vector<SpringGroup> groups;
  RandomSprings random;
};
struct BlockEnvironment {
  BlockWithHole block;
  double grid = 0.0001;  ///< of the density field [m]
  Density density = Density::signed_distance;
  bool per_cell = false;  ///< lists a vertex for each cell that has it on an edge, as thesis 2.1 and C.2; else once
};
struct PointShellEnvironment {
  std::string file;            ///< CSV or PLY, relative to the scenario file
  std::optional<double> grid;  ///< cell of the local average [m]
};
struct MeshEnvironment {
  std::string file;               ///< OBJ, PLY, STL or OFF, relative to the scenario file
  double scale = 1.0;             ///< [m] for each unit of the file
  std::optional<double> spacing;  ///< resampled to this [m]
  std::optional<double> grid;     ///< cell of the local average [m]
  bool flip = false;              ///< an open surface's outside is its inside
};
using Environment = std::variant<SpringsEnvironment, Hole2d, Plane, Slot, BlockEnvironment, PointShellEnvironment,
                                 MeshEnvironment, ConicalHole>;

struct InitialFields {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

struct CylinderFields {
  double diameter = 0.001;  ///< [m]
  double length = 0.01;     ///< [m]
  Tip tip = Tip::flat;
};
struct RevolvedFields {
  std::vector<ProfilePoint> profile;
  Tip tip = Tip::flat;
};
struct BurFields {
  BurFamily family = BurFamily::ball;
  double diameter = 0.001;               ///< of the head, where it is widest [m]
  std::optional<double> length;          ///< of the head [m]; none: as long as it is wide
  std::optional<double> shank_diameter;  ///< [m]; none: kShankShare of the head's
  static constexpr double kShankShare = 0.6;
};
struct MeshToolFields {
  std::string file;            ///< OBJ, PLY, STL or OFF, relative to the scenario file
  double scale = 1.0;          ///< [m] for each unit of the file
  Vec3 tip = Vec3::Zero();     ///< place of the file that is the tip centre [m]
  Vec3 tip_axis = {0, 0, -1};  ///< where the tip points in the file; of any length
  std::optional<double> grid;  ///< spacing of the signed distances [m]
};
using ToolFields = std::variant<CylinderFields, RevolvedFields, BurFields, MeshToolFields>;

struct OrientationFields {
  Vec3 up = {0.0, 1.0, 0.0};
  Vec3 lean = {1.0, 0.0, 0.0};
  Profile tilt;
  Profile azimuth;
  Profile roll;
};
struct FreePosition {};
struct PrescribedPosition {
  std::array<Profile, 3> coordinates;  ///< [m]
};
struct RecordedPosition {
  std::string file;  ///< CSV, relative to the scenario file
};
using PositionFields = std::variant<FreePosition, PrescribedPosition, RecordedPosition>;
struct MotionFields {
  std::optional<OrientationFields> orientation = OrientationFields{};  ///< none with a recorded position alone
  PositionFields position;
};

/// True when forces move the tool's tip, false when a script or a recording prescribes its place.
inline bool position_is_free(const MotionFields& motion) {
  return std::holds_alternative<FreePosition>(motion.position);
}

struct NoHandFields {};
struct ForceHandFields {
  std::array<Profile, 3> force;  ///< [N]
};
struct PushHandFields {
  Profile force;         ///< [N]
  double angle = 0.0;    ///< from straight down [rad]
  double azimuth = 0.0;  ///< of the lean, from +x about z [rad]
};
struct ImpedanceHandFields {
  double stiffness = 300.0;            ///< [N/m]
  double damping = 6.0;                ///< [N s/m]
  std::array<Profile, 3> target;       ///< [m]
  std::optional<TremorConfig> tremor;  ///< none: the hand follows the target alone
};
/// A passive hand, fixed to the handle of an impedance device.
struct MassSpringDamperHandFields {
  double mass = 0.2;           ///< [kg]
  ImpedanceHandFields spring;  ///< and damper, towards the target
};
struct DragHandFields {
  Drag drag;
  std::optional<std::vector<Vec3>> path;  ///< [m]; it or the direction
  std::optional<Vec3> direction;
  std::optional<double> tilt = 0.0;  ///< [rad]; none: the orientation is that of the motion
  double azimuth = 0.0;              ///< [rad]
  double smoothing = 0.0005;         ///< radius of SmoothedSurface [m]
};
/// The length of the whole path, or of the way along the direction in `duration` [s] [m].
double drag_length(const DragHandFields& hand, double duration);

/// The man-machine experiments: every subject does every trial from the initial state.
struct TrackingHandFields {
  static constexpr std::size_t kMostPlaces = 100;  ///< of targets
  TargetRules task;
  std::vector<Subject> subjects = {Subject{}};
  std::int64_t trials = 1;
};
using HandFields = std::variant<NoHandFields, ForceHandFields, PushHandFields, ImpedanceHandFields, DragHandFields,
                                TrackingHandFields, MassSpringDamperHandFields>;

/// The spring and damper towards a target that a hand is, or is fixed to; null of other hands.
inline const ImpedanceHandFields* spring_of(const HandFields& hand) {
  const auto* passive = std::get_if<MassSpringDamperHandFields>(&hand);
  return passive != nullptr ? &passive->spring : std::get_if<ImpedanceHandFields>(&hand);
}

struct IdealDeviceFields {
  std::optional<double> force_limit;  ///< [N]
};
using DeviceFields = std::variant<IdealDeviceFields, AdmittanceDeviceConfig, ImpedanceDeviceConfig>;

/// True when the handle moves the tool: there is no virtual mass, so that the integrator and f_in have no part in it.
inline bool handle_moves_tool(const DeviceFields& device) {
  return std::holds_alternative<ImpedanceDeviceConfig>(device);
}
/// Threshold of the input-force limiter [N], if the device has one.
std::optional<double> input_force_limit(const DeviceFields& device);

struct IntegratorFields {
  const IntegratorEntry* type = &kLeapfrog;  ///< never null
  double tolerance = kEventTolerance;        ///< of `event` [s]
};

struct RecordFields : TrajectoryExtras {
  bool trajectory = true;
  std::int64_t every = 1;
  std::vector<std::int64_t> ratio_iterations;
  bool contacts = false;
  bool stiffness_tensor = false;
  bool timing = false;
  bool energy = false;
  bool ideal_trajectory = false;
  bool force_reference = false;
};

/// True when a run writes rows of its steps.
bool records_rows(const RecordFields& record);

/// The force that an ideal rendering would give on a prescribed way.
struct ReferenceForceFields {
  std::array<Profile, 3> force;  ///< [N]
};

struct MetricBound {
  std::optional<double> min;
  std::optional<double> max;
};
/// The conditions for a run to count as expected: one of the outcomes, and bounds on metrics.
struct ExpectFields {
  std::vector<Outcome> outcomes = {Outcome::completes, Outcome::leaves_hole, Outcome::tool_horizontal};
  std::map<std::string, MetricBound> metrics;
};

struct Scenario {
  // Defined in one source: each that copied the alternatives below would compile the copies anew.
  Scenario();
  Scenario(const Scenario&);
  Scenario(Scenario&&) noexcept;
  Scenario& operator=(const Scenario&);
  Scenario& operator=(Scenario&&) noexcept;
  ~Scenario();

  std::string name;
  std::string description;
  std::string source;
  std::int64_t seed = 1;
  TimeFields time;
  Environment environment;
  InitialFields initial;
  ToolFields tool;
  MotionFields motion;
  HandFields hand;
  DeviceFields device;
  RenderingConfig rendering;
  IntegratorFields integrator;
  DivergenceBounds bounds;
  std::optional<ReferenceForceFields> reference_force;
  RecordFields record;
  SettlingRule metrics;
  ExpectFields expect;

  std::filesystem::path directory;  ///< of the scenario file: what relative paths of the files it names start from
};

/// Runs of the scenario: one for each subject and trial of a tracking hand. May be more than any integer holds.
double trial_count(const HandFields& hand);

/// True when the contacts are not those of the scenario's own search, but of a recording or a library.
bool has_other_contacts(const Scenario& scenario);

/// The scenario with another algorithm, whose name is known, and the depth model and reduction that it fixes.
Scenario with_algorithm(Scenario scenario, std::string_view algorithm);

}  // namespace hapbench
