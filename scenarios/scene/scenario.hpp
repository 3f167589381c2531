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

/// The contents of a scenario file as plain structs. Default member values are the defaults of a scenario with
/// springs. The functions `describe` in this folder list the names, units and ranges of the fields.
namespace hapbench {

/// Conditions that end a run early. The run then has the outcome with the same name.
enum class StopCondition { leaves_hole, tool_horizontal };

struct TimeFields {
  double step = 0.0005;                  ///< [s]
  std::int64_t steps = 1;                ///< number of time steps
  std::vector<StopCondition> stop_when;  ///< empty: the run never ends early
  /// The metrics use only every stride-th time step. Two runs with different time steps are thus sampled at the same
  /// times if the product of step and stride is equal. Not a field of the scenario file.
  std::int64_t stride = 1;
};

/// Springs with the same direction.
struct SpringGroup {
  Vec3 direction = {1.0, 0.0, 0.0};  ///< depth gradient; make_springs normalises it
  std::int64_t count = 1;
};
/// Springs with random directions.
struct RandomSprings {
  std::int64_t count = 0;
  bool planar = true;  ///< true: directions in the plane z = 0; false: directions in space
};
/// Springs between the tool's tip and the origin, without a surface.
struct SpringsEnvironment {
  bool bilateral = true;  ///< true: springs push and pull; false: a spring acts only while its depth is positive
  /// Depth of a spring: <p, u> if true, |<p, u>| if false, with the tip's position p and the spring's direction u.
  bool signed_depths = true;
  std::vector<SpringGroup> groups;
  RandomSprings random;
};
struct BlockEnvironment {
  BlockWithHole block;
  double grid = 0.0001;  ///< spacing of the density field [m]
  Density density = Density::signed_distance;
  /// true: the shell contains a vertex several times, once for each grid cell that shares it (thesis 2.1, C.2);
  /// false: the shell contains each vertex once.
  bool per_cell = false;
};
struct PointShellEnvironment {
  std::string file;            ///< CSV or PLY, relative to the scenario file
  std::optional<double> grid;  ///< edge length of the local average's grid cells [m]; empty: no cells
};
struct MeshEnvironment {
  std::string file;               ///< OBJ, PLY, STL or OFF, relative to the scenario file
  double scale = 1.0;             ///< length of the file's unit [m]
  std::optional<double> spacing;  ///< spacing after resampling [m]; empty: no resampling
  std::optional<double> grid;     ///< see PointShellEnvironment::grid
  bool flip = false;              ///< true: the normals of an open surface are reversed
};
using Environment = std::variant<SpringsEnvironment, Hole2d, Plane, Slot, BlockEnvironment, PointShellEnvironment,
                                 MeshEnvironment, ConicalHole>;

/// State at t = 0.
struct InitialFields {
  Vec3 position = Vec3::Zero();  ///< position of the tip centre [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

struct CylinderFields {
  double diameter = 0.001;  ///< [m]
  double length = 0.01;     ///< distance from the tip plane to the far end [m]
  Tip tip = Tip::flat;
};
/// A solid of revolution.
struct RevolvedFields {
  std::vector<ProfilePoint> profile;  ///< outline, from the far end to the tip
  Tip tip = Tip::flat;
};
/// A dental or bone bur: a head with a shank.
struct BurFields {
  BurFamily family = BurFamily::ball;
  double diameter = 0.001;               ///< largest diameter of the head [m]
  std::optional<double> length;          ///< length of the head [m]; empty: its diameter
  std::optional<double> shank_diameter;  ///< [m]; empty: kShankRatio times the head's diameter
  static constexpr double kShankRatio = 0.6;
};
struct MeshToolFields {
  std::string file;            ///< OBJ, PLY, STL or OFF, relative to the scenario file
  double scale = 1.0;          ///< length of the file's unit [m]
  Vec3 tip = Vec3::Zero();     ///< tip centre in the file's frame, after scaling [m]
  Vec3 tip_axis = {0, 0, -1};  ///< direction in which the tip points, in the file's frame; any norm
  std::optional<double> grid;  ///< spacing of the signed-distance grid [m]; empty: about 128^3 nodes
};
using ToolFields = std::variant<CylinderFields, RevolvedFields, BurFields, MeshToolFields>;

/// A scripted orientation of the tool (sim/tool/motion.hpp).
struct OrientationFields {
  Vec3 up = {0.0, 1.0, 0.0};    ///< direction against gravity
  Vec3 lean = {1.0, 0.0, 0.0};  ///< direction in which the tool tilts at azimuth 0; perpendicular to up
  Profile tilt;                 ///< [rad]
  Profile azimuth;              ///< [rad]
  Profile roll;                 ///< rotation about the tool's axis [rad]
};
/// The position of a tool that forces move.
struct FreePosition {};
struct PrescribedPosition {
  std::array<Profile, 3> coordinates;  ///< [m]
  std::optional<Vec3> shift;           ///< shifts the whole path [m]; empty: no shift
};
struct RecordedPosition {
  std::string file;  ///< CSV, relative to the scenario file
};
using PositionFields = std::variant<FreePosition, PrescribedPosition, RecordedPosition>;
struct MotionFields {
  std::optional<OrientationFields> orientation = OrientationFields{};  ///< empty only if the position is recorded
  PositionFields position;
};

/// Returns true if forces move the tool's tip, false if a script or a recording prescribes its position.
inline bool position_is_free(const MotionFields& motion) {
  return std::holds_alternative<FreePosition>(motion.position);
}

/// No hand holds the handle.
struct NoHandFields {};
struct ForceHandFields {
  std::array<Profile, 3> force;  ///< [N]
};
struct PushHandFields {
  Profile force;         ///< [N]
  double angle = 0.0;    ///< angle between the force and -z [rad]
  double azimuth = 0.0;  ///< direction of the force's horizontal part: angle about z from +x [rad]
};
/// A spring and a damper between the handle and a moving target.
struct ImpedanceHandFields {
  double stiffness = 300.0;            ///< [N/m]
  double damping = 6.0;                ///< [N s/m]
  std::array<Profile, 3> target;       ///< [m]
  std::optional<TremorConfig> tremor;  ///< empty: no tremor
};
/// A passive hand that is fixed to the handle of an impedance device.
struct MassSpringDamperHandFields {
  double mass = 0.2;           ///< [kg]
  ImpedanceHandFields spring;  ///< spring and damper towards the target
};
/// A hand that leads the tool over the surface and presses along the normal. Either `path` or `direction` is set.
struct DragHandFields {
  Drag drag;
  std::optional<std::vector<Vec3>> path;  ///< points on or near the surface [m]
  std::optional<Vec3> direction;          ///< direction of travel along the surface, from the initial position
  /// Angle between the tool's axis and the normal [rad]. Empty: the motion gives the orientation.
  std::optional<double> tilt = 0.0;
  double azimuth = 0.0;       ///< direction of the tilt: angle about the normal from the direction of travel [rad]
  double smoothing = 0.0005;  ///< radius R over which SmoothedSurface averages points of the shell [m]
};
/// Returns the length of the drag hand's path [m]. If the hand has a direction and no path, returns the distance
/// that it travels in `duration` [s].
double drag_length(const DragHandFields& hand, double duration);

/// The simulated subjects of a target-tracking experiment. Every subject does `trials` trials, and each trial starts
/// from the initial state.
struct TrackingHandFields {
  static constexpr std::size_t kMaxTargetPositions = 100;  ///< maximum number of target positions
  TargetRules task;
  std::vector<Subject> subjects = {Subject{}};
  std::int64_t trials = 1;  ///< trials of each subject
};
using HandFields = std::variant<NoHandFields, ForceHandFields, PushHandFields, ImpedanceHandFields, DragHandFields,
                                TrackingHandFields, MassSpringDamperHandFields>;

/// Returns false for a hand whose force does not depend on the motion of the handle: none, force and push.
inline bool reacts_to_handle(const HandFields& hand) {
  return !std::holds_alternative<NoHandFields>(hand) && !std::holds_alternative<ForceHandFields>(hand) &&
         !std::holds_alternative<PushHandFields>(hand);
}

/// Returns the spring and damper of a hand of type impedance or mass_spring_damper; null for all other hands.
inline const ImpedanceHandFields* spring_of(const HandFields& hand) {
  const auto* passive = std::get_if<MassSpringDamperHandFields>(&hand);
  return passive != nullptr ? &passive->spring : std::get_if<ImpedanceHandFields>(&hand);
}

struct IdealDeviceFields {
  std::optional<double> force_limit;  ///< [N]; empty: no limit
};
using DeviceFields = std::variant<IdealDeviceFields, AdmittanceDeviceConfig, ImpedanceDeviceConfig>;

/// Returns true if the tool follows the handle's position (impedance device). Then there is no virtual mass, and
/// neither the integrator nor the input force f_in is used.
inline bool handle_moves_tool(const DeviceFields& device) {
  return std::holds_alternative<ImpedanceDeviceConfig>(device);
}
/// Returns the threshold of the input-force limiter [N], or nullopt if the device has no limiter.
std::optional<double> input_force_limit(const DeviceFields& device);

struct IntegratorFields {
  const IntegratorEntry* type = &kLeapfrog;  ///< never null
  double tolerance = kEventTolerance;        ///< time tolerance of the integrator `event` [s]
};

/// The tables that a run writes besides its summary, and the optional sections of the summary.
struct RecordFields : TrajectoryExtras {
  bool trajectory = true;
  std::int64_t every = 1;  ///< records every n-th time step
  std::vector<std::int64_t> ratio_iterations;
  bool contacts = false;
  bool stiffness_tensor = false;
  bool timing = false;
  bool energy = false;
  bool ideal_trajectory = false;
  bool force_reference = false;
  bool six_dof = false;
};

/// Returns true if a run records its time steps in any table.
bool records_rows(const RecordFields& record);

/// A reference force (the force that an ideal rendering would give) that the scenario gives as functions of time.
struct GivenForceFields {
  std::array<Profile, 3> force;  ///< [N]
};
/// The reference force is k (x' - x). x' is the collision-free position at which a tool that a spring pulls towards x
/// rests, without friction, on the rigid triangles of the mesh (scenarios/run/rigid_contact_force.hpp). If the tool's
/// position is prescribed, x is this position and k is rendering.stiffness. Otherwise x is the target of the hand's
/// spring and k is the stiffness of this spring.
struct RigidContactFields {};
using ReferenceForceFields = std::variant<GivenForceFields, RigidContactFields>;

/// Value of SixDofFields::law that selects the algorithm "proxy" with the rotational stiffness
/// HandAndCoupling::matched_rotation(). With this stiffness, and with the grip at the force point, the proxy on a 3-DOF
/// device renders the force of a 6-DOF device.
inline constexpr const char* kMatchedProxy = "matched_proxy";

/// Parameters of the comparison with a 6-DOF device (SixDofObserver): the law on the 3-DOF device, springs of hand and
/// coupling, and the positions of force point, grip and pivot on the tool's axis. Both devices apply their force at
/// the force point.
struct SixDofFields {
  std::string law;                 ///< name of an algorithm, or kMatchedProxy; empty: the scenario's algorithm
  double hand = 500.0;             ///< K_h, stiffness of the hand [N/m]
  double hand_rotation = 0.2;      ///< K_phi, rotational stiffness of the hand about the grip [N m/rad]
  double coupling_rotation = 0.4;  ///< K_r, rotational stiffness of the 6-DOF coupling [N m/rad]
  double force_point = 0.0;        ///< distance from the tip centre back to the force point [m]
  double grip = 0.0;               ///< c, distance from the force point to the grip, towards the tip [m]
  double pivot = 0.0;  ///< distance from the tip centre back to the point about which rotations turn the tool [m]
};

/// Bounds of a metric. An empty bound is not checked.
struct MetricBound {
  std::optional<double> min;
  std::optional<double> max;
};
/// Expectations of a run. A run meets them if it has one of `outcomes` and every metric is within its bounds.
struct ExpectFields {
  std::vector<Outcome> outcomes = {Outcome::completes, Outcome::leaves_hole, Outcome::tool_horizontal};
  std::map<std::string, MetricBound> metrics;  ///< bounds by the name of the metric
};

struct Scenario {
  // Defined in scenario.cpp to save compile time. Otherwise every source that copies a scenario would compile the
  // copying of all variants again.
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
  std::optional<SixDofFields> six_dof;
  RecordFields record;
  SettlingRule metrics;
  ExpectFields expect;

  std::filesystem::path directory;  ///< folder of the scenario file; relative paths of files start from it
};

/// Returns the number of trials of a run: number of subjects times trials of each subject for a tracking hand,
/// otherwise 1. The type is double, because the product may exceed the range of integers.
double trial_count(const HandFields& hand);

/// Returns true if the contacts come from a recording or a shared library, and not from hapbench's contact
/// search.
bool has_external_contacts(const Scenario& scenario);

/// Returns true if some steps use contacts of an earlier step, because contacts are searched at a lower rate, delayed
/// or lost. An analysis of the contact as a control loop with the period of one time step is then not valid.
inline bool has_multi_rate_contacts(const Scenario& scenario) {
  return scenario.rendering.multi_rate && scenario.rendering.multi_rate->any();
}

/// Returns the scenario with another algorithm, and with the depth model and reduction that this algorithm fixes.
/// Precondition: `algorithm` is the name of a registered algorithm.
Scenario with_algorithm(Scenario scenario, std::string_view algorithm);

}  // namespace hapbench
