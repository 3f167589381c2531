#include "scenarios/program/scenario_start.hpp"

namespace hapbench {
namespace {

const std::string kPlane = R"(
  "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0001},)";
const std::string kMesh = R"(
  "environment": {"type": "mesh", "file": @surface@, "scale": @scale@, "spacing_m": @spacing@@flip@},)";
const std::string kShell = R"(
  "environment": {"type": "point_shell", "file": @surface@},)";
const std::string kBlock = R"(
  "environment": {"type": "block_with_hole", "hole_diameter_m": 0.002, "hole_depth_m": 0.005, "grid_m": 0.0001},)";

const std::string kAbove = R"(
  "initial": {"position_m": [@x@, @y@, @z@]},
  "tool": {"diameter_m": @diameter@, "length_m": @length@, "tip": "round"},)";
const std::string kBurAbove = R"(
  "initial": {"position_m": [@x@, @y@, @z@]},
  "tool": {"type": "bur", "family": "ball", "diameter_m": @diameter@},)";
const std::string kMeshToolAbove = R"(
  "initial": {"position_m": [@x@, @y@, @z@]},
  "tool": {"type": "mesh", "file": @file@, "scale": @tool_scale@, "tip_m": @tip@, "tip_axis": @tip_axis@,
           "grid_m": null},)";
const std::string kInHole = R"(
  "initial": {"position_m": [0, 0, -0.0049]},
  "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "flat"},)";

const std::string kPress = R"(
  "hand": {
    "type": "impedance", "stiffness_N_per_m": 300, "damping_N_s_per_m": 6,
    "target": {
      @target@
    }
  },)";
const std::string kDrag = R"(
  "hand": {
    "type": "drag", "force_N": 1, @way@, "speed_m_per_s": @speed@, "tilt_rad": 0.3,
    "smoothing_m": @smoothing@
  },)";
const std::string kTurn = R"(
  "motion": {"orientation": {"tilt_rad": {"type": "sine", "mean": 0.2, "amplitude": 0.2, "period_s": 1}}},
  "hand": {"type": "force", "z_N": -1},)";
const std::string kStroke = R"(
  "motion": {"position": {"type": "file", "file": @file@}},)";
const std::string kTrack = R"(
  "hand": {
    "type": "tracking",
    "task": {"places_m": [[0, 0, -0.005], [0.0005, 0, -0.005]], "targets_per_place": 1, "tolerance_m": 0.0002},
    "subjects": [{"reaction_delay_s": 0.2, "press_N": 1.6}],
    "trials": 1
  },)";
const std::string kSprings = R"(
  "environment": {
    "type": "springs",
    "groups": [{"direction": [1, 0, 0], "count": 3}, {"direction": [0, 1, 0], "count": 1}]
  },
  "initial": {"position_m": [0.005, -0.005, 0]},)";

const std::string kRendering = R"(
  "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 20000, "damping_ratio": 0.7, "mass_kg": 0.1}
)";

}  // namespace

const std::vector<StartKind>& start_kinds() {
  using enum StartSource;
  static const std::vector<StartKind> kinds = {
      {"mesh", "a drill is pressed on a surface from a file: OBJ, PLY, STL or OFF", mesh, true,
       kMesh + kAbove + kPress + kRendering},
      {"shell", "a drill is pressed on points with normals from a file: CSV or PLY", shell, true,
       kShell + kAbove + kPress + kRendering},
      {"drag", "a drill is dragged over a surface with 1 N along its normal", mesh, false,
       kPlane + kAbove + kDrag + kRendering},
      {"bur", "a ball bur is dragged over a surface with 1 N along its normal", mesh, false,
       kPlane + kBurAbove + kDrag + kRendering},
      {"tool", "a tool from a mesh file is pressed on a plane: OBJ, PLY, STL or OFF, closed", mesh, true,
       kPlane + kMeshToolAbove + kPress + kRendering},
      {"plane", "a drill is pressed on a plane", none, false, kPlane + kAbove + kPress + kRendering},
      {"hole", "a drill is turned to and fro in a drilled hole", none, false, kBlock + kInHole + kTurn + kRendering},
      {"springs", "a point mass between springs", none, false, kSprings + kRendering},
      {"stroke", "a recorded stroke is played back over a plane or, with --on, a mesh: CSV", stroke, true,
       kPlane + kStroke + kRendering},
      {"target", "a simulated subject leads a drill to targets in a hole", none, false,
       kBlock + kInHole + kTrack + kRendering, 40'000},
  };
  return kinds;
}

std::string on_mesh(const StartKind& kind) {
  return kMesh + kind.sections.substr(kPlane.size());
}

}  // namespace hapbench
