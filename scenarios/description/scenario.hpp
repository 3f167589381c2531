#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/tracking_hand.hpp"
#include "sim/core/profile.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/geometry/block_with_hole.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/tool.hpp"

/// A scenario file as plain structs. Fields whose default depends on the kind of scene are std::optional here and
/// filled in by `fill_defaults`. Names, units and ranges: scenario_codec.cpp.
namespace hapbench {

struct TimeFields {
  double step = 0.0005;                ///< [s]
  std::optional<std::int64_t> steps;   ///< rows; exactly one of the two is given
  std::optional<double> duration;      ///< [s]
  std::vector<std::string> stop_when;  ///< "leaves_hole", "tool_horizontal"
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
  std::vector<SpringGroup> groups;
  RandomSprings random;
};
struct BlockEnvironment {
  BlockWithHole block;
  double grid = 0.0001;                     ///< of the density field [m]
  std::string density = "signed_distance";  ///< or "binary"
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
};
using Environment =
    std::variant<SpringsEnvironment, Hole2d, Plane, Slot, BlockEnvironment, PointShellEnvironment, MeshEnvironment>;

struct InitialFields {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

struct ToolFields {
  std::optional<double> diameter;  ///< [m]
  std::optional<double> length;    ///< [m]
  std::optional<std::string> tip;  ///< "flat", "round"
};

struct OrientationFields {
  std::optional<Vec3> up;
  Vec3 lean = {1.0, 0.0, 0.0};
  Profile tilt;
  Profile azimuth;
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
  std::optional<OrientationFields> orientation;  ///< a recorded motion has none
  PositionFields position;
};

struct NoHandFields {};
struct ForceHandFields {
  std::array<Profile, 3> force;  ///< [N]
};
struct ImpedanceHandFields {
  double stiffness = 300.0;       ///< [N/m]
  double damping = 6.0;           ///< [N s/m]
  std::array<Profile, 3> target;  ///< [m]
};
/// The man-machine experiments: every subject does every trial from the initial state.
struct TrackingHandFields {
  TargetRules task;
  std::vector<Subject> subjects = {Subject{}};
  std::int64_t trials = 1;
};
using HandFields = std::variant<NoHandFields, ForceHandFields, ImpedanceHandFields, TrackingHandFields>;

struct IdealDeviceFields {
  std::optional<double> force_limit;  ///< [N]
};
using DeviceFields = std::variant<IdealDeviceFields, AdmittanceDeviceConfig>;

struct IntegratorFields {
  const IntegratorEntry* type = &kLeapfrog;  ///< never null
};

/// The part of RenderingConfig that has one default for every scene, and beside it what depends on the scene.
struct RenderingFields {
  RenderingConfig config;
  std::optional<std::string> depth_model;
  std::optional<std::optional<ReductionConfig>> reduction;
  std::optional<double> mass;
  std::optional<double> mu_s;
  std::optional<double> mu_f;
};

struct RecordFields {
  bool trajectory = true;
  std::int64_t every = 1;
  std::vector<std::int64_t> ratio_iterations;
  bool contacts = false;
  bool stiffness_tensor = false;
  bool timing = false;
  bool energy = false;
  bool ideal_trajectory = false;
};

/// True when a run writes rows of its steps.
bool records_rows(const RecordFields& record);

struct MetricBound {
  std::optional<double> min;
  std::optional<double> max;
};
/// What the run must show to count as expected: one of the outcomes, and bounds on metrics.
struct ExpectFields {
  std::vector<std::string> outcomes = {"completes", "leaves_hole", "tool_horizontal"};
  std::map<std::string, std::optional<MetricBound>> metrics;
};

struct Scenario {
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
  RenderingFields rendering;
  IntegratorFields integrator;
  DivergenceBounds bounds;
  RecordFields record;
  ExpectFields expect;

  std::filesystem::path directory;  ///< of the scenario file: what relative paths start from
};

/// Where a file named in the scenario lies.
std::filesystem::path resolve_path(const Scenario& scenario, const std::string& file);

/// Fills in every default that depends on the kind of scene (the thesis's parameters of that scene) and whatever the
/// algorithm fixes. Returns a warning for each given value that the algorithm's definition overrides. Throws InputError
/// for contradictions that involve a default.
std::vector<std::string> fill_defaults(Scenario& scenario);

/// The sections of a summary that not every run has.
struct MetricSections {
  bool energy = true;
  bool ideal_trajectory = true;
  std::size_t places = 2;  ///< target places; the thesis's tasks have two
};

/// Names of the metrics of runs with these sections, in the order of the summary; by default those `expect` may bound.
std::vector<std::string> metric_names(const MetricSections& sections = {});

}  // namespace hapbench
