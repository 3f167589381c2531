#include "scenarios/program/scenario_start.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

const std::string kPlane = R"(
  "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0001},)";
const std::string kMesh = R"(
  "environment": {"type": "mesh", "file": @file@, "scale": @scale@, "spacing_m": @spacing@},)";
const std::string kShell = R"(
  "environment": {"type": "point_shell", "file": @file@},)";
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
      "x_m": @x@, "y_m": @y@,
      "z_m": {"type": "waypoints", "points": [[0, @z@], [0.5, @z_pressed@]], "interpolation": "cosine"}
    }
  },)";
const std::string kDrag = R"(
  "hand": {
    "type": "drag", "force_N": 1, "direction": [@dx@, @dy@, 0], "speed_m_per_s": @speed@, "tilt_rad": 0.3,
    "smoothing_m": @smoothing@
  },)";
const std::string kTurn = R"(
  "motion": {"orientation": {"tilt_rad": {"type": "sine", "mean": 0.3, "amplitude": 0.2, "period_s": 1}}},
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

constexpr double kStep = 0.0005;          ///< [s]
constexpr double kToothLength = 0.01;     ///< [m]
constexpr double kClearance = 0.001;      ///< between tool and surface at the start [m]
constexpr double kDragSpeed = 5.0;        ///< in diameters of the tool [1/s]
constexpr double kPressedBelow = 0.0035;  ///< the hand's target, 1 N below the surface with kPress [m]

/// The values by their names @name@ in the templates.
using Values = std::map<std::string, Json>;

/// Rounds to two significant digits, as people write lengths.
double rounded(double value) {
  return std::stod(fmt::format("{:.2g}", value));
}

Box box_of(const std::vector<Vec3>& places) {
  Box box{places.front(), places.front()};
  for (const Vec3& place : places) box = {box.min.cwiseMin(place), box.max.cwiseMax(place)};
  return box;
}

Box box_of(const std::vector<SurfacePoint>& points) {
  std::vector<Vec3> places;
  for (const SurfacePoint& point : points) places.push_back(point.position);
  return box_of(places);
}

/// The point nearest to the middle of those within `tolerance` of the top.
Vec3 middle_of_the_top(const std::vector<SurfacePoint>& points, double top, double tolerance) {
  std::vector<Vec3> high;
  for (const SurfacePoint& point : points) {
    if (point.position.z() >= top - tolerance) high.push_back(point.position);
  }
  Vec3 middle = Vec3::Zero();
  for (const Vec3& place : high) middle += place;
  middle /= static_cast<double>(high.size());
  return *std::ranges::min_element(high, {}, [&middle](const Vec3& place) { return (place - middle).norm(); });
}

/// The highest of the points above or below the box's middle, to within `aside`; where there are none, as in a ring,
/// the middle.
Vec3 top_of_the_middle(const std::vector<SurfacePoint>& points, const Box& box, double aside) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  Vec3 top(middle.x(), middle.y(), box.min.z());
  for (const SurfacePoint& point : points) {
    if ((point.position - middle).head<2>().norm() <= aside && point.position.z() > top.z()) top = point.position;
  }
  return top.z() > box.min.z() ? top : middle;
}

/// The unit, of m, cm and mm, in which the length is nearest to a tooth's.
double guessed_scale(double longest) {
  const auto misfit = [longest](double scale) { return std::abs(std::log(longest * scale / kToothLength)); };
  return std::min({1.0, 0.01, 0.001}, [&misfit](double a, double b) { return misfit(a) < misfit(b); });
}

/// Rounds to the micrometre, as people write places.
double to_micrometres(double metres) {
  return std::round(1e6 * metres) / 1e6;
}

/// A way over a surface for a hand that drags.
struct DragStart {
  Vec3 position = Vec3::Zero();    ///< initial.position_m [m]
  Vec3 direction = Vec3::UnitX();  ///< hand.direction
  double smoothing = 0.0;          ///< hand.smoothing_m [m]
  double room = 0.0;               ///< length of the way to where the surface ends or turns back [m]
};

/// Tries along x and y, forwards and back, from each of `positions`, then with twice and four times `smoothing`, until
/// a way is at least `enough` long; else takes the longest. A later direction or place has to lead a tenth further, so
/// that the choice does not depend on rounding. Makes a walk of some 10 ms for each combination. Preconditions: a point
/// in the shell, a position.
DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough) {
  constexpr double kFurther = 1.1;
  const Box box = shell.bounds();
  const double furthest = (box.max - box.min).norm();
  DragStart best{positions.front(), Vec3::UnitX(), smoothing, 0.0};
  for (const double radius : {smoothing, 2.0 * smoothing, 4.0 * smoothing}) {
    const SmoothedSurface surface(shell, radius);
    for (const Vec3& position : positions) {
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
        const double room = SurfacePath::along(surface, position, direction, furthest).length();
        if (room > kFurther * best.room) best = {position, direction, radius, room};
      }
      if (best.room >= enough) return best;
    }
  }
  return best;
}

/// Mean and variance of a surface.
struct Spread {
  Vec3 middle;
  Mat3 variance;  ///< about the middle [m^2]
};

Spread spread_of(const TriangleSoup& mesh) {
  double area = 0.0;
  Vec3 sum = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double weight = (q - p).cross(r - p).norm();
    // The mean of a quadratic over a triangle is its mean over the middles of the sides.
    for (const Vec3& place : {Vec3(0.5 * (p + q)), Vec3(0.5 * (q + r)), Vec3(0.5 * (r + p))}) {
      sum += weight / 3.0 * place;
      second += weight / 3.0 * place * place.transpose();
    }
    area += weight;
  }
  const Vec3 middle = sum / area;
  return {middle, second / area - middle * middle.transpose()};
}

/// The direction along which a surface is clearly longest; a coordinate axis when it is near one.
std::optional<Vec3> longest_direction(const Mat3& variance) {
  constexpr double kStandsOut = 2.0;  // ratio of variances
  // Cosine of 6 degrees: tools are modelled along an axis, but are seldom exactly symmetric about it.
  constexpr double kNearAxis = 0.995;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(variance);
  if (principal.eigenvalues()[2] < kStandsOut * principal.eigenvalues()[1]) return std::nullopt;
  const Vec3 direction = principal.eigenvectors().col(2);
  Eigen::Index nearest = 0;
  return direction.cwiseAbs().maxCoeff(&nearest) > kNearAxis ? Vec3(-Vec3::Unit(nearest)) : direction;
}

/// The end of a mesh along a direction.
struct End {
  Vec3 place;        ///< the middle of the last hundredth's vertices, moved to the very end
  double thickness;  ///< mean distance of the last tenth's vertices from the line through the mesh's middle
};

End end_along(const TriangleSoup& mesh, const Vec3& direction, const Vec3& middle) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Vec3& vertex : mesh.vertices) {
    least = std::min(least, direction.dot(vertex - middle));
    most = std::max(most, direction.dot(vertex - middle));
  }
  Vec3 aside = Vec3::Zero();
  double thickness = 0.0, in_tenth = 0.0, in_hundredth = 0.0;
  for (const Vec3& vertex : mesh.vertices) {
    const double along = direction.dot(vertex - middle), from_end = (most - along) / (most - least);
    const Vec3 across = vertex - middle - along * direction;
    if (from_end <= 0.1) thickness += across.norm(), in_tenth += 1.0;
    if (from_end <= 0.01) aside += across, in_hundredth += 1.0;
  }
  return {middle + most * direction + aside / in_hundredth, thickness / in_tenth};
}

/// The guessed tip of a tool's mesh.
struct TipOfMesh {
  Vec3 place;      ///< the end of its longest direction where it is thinner [m]
  Vec3 direction;  ///< out of the tip, a unit vector
};

/// Guesses a tool's tip. A mesh without a longest direction has it at its lowest place, along -z. Precondition: it has
/// triangles.
TipOfMesh guess_tip(const TriangleSoup& mesh) {
  const auto [middle, variance] = spread_of(mesh);
  const std::optional<Vec3> longest = longest_direction(variance);
  const Vec3 direction = longest.value_or(-Vec3::UnitZ());
  const End end = end_along(mesh, direction, middle), other = end_along(mesh, -direction, middle);
  if (longest && other.thickness < end.thickness) return {other.place, -direction};
  return {end.place, direction};
}

/// A start that is being made: its values are determined one after the other.
class Start {
 public:
  Start(const StartKind& kind, const std::optional<fs::path>& source, const fs::path& directory)
      : description_(kind.summary), sections_(kind.sections + kRendering), directory_(directory) {
    if (kind.source == StartSource::mesh && !kind.needs_source && source) sections_.replace(0, kPlane.size(), kMesh);
    values_["steps"] = kind.steps;
    if (source) values_["file"] = fs::proximate(*source, directory.empty() ? "." : directory).generic_string();
    if (has("@scale@")) scale_environment();
    if (has("@tool_scale@")) {
      place_mesh_tool();
    } else if (has("@x@")) {
      place_tool();
    }
    if (has(kStroke)) choose_stroke_steps();
  }

  ScenarioStart result() const { return {text(), notes_, warnings_}; }

 private:
  bool has(const std::string& part) const { return sections_.find(part) != std::string::npos; }

  std::string text() const {
    std::string text = fmt::format("{{\n  \"description\": {},\n  \"time\": {{\"step_s\": {}, \"steps\": @steps@}},",
                                   Json(description_).dump(), kStep) +
                       sections_ + "}\n";
    for (const auto& [name, value] : values_) {
      const std::string mark = "@" + name + "@", with = value.dump();
      for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += with.size())
        text.replace(at, mark.size(), with);
    }
    return text;
  }

  LoadedScenario scenario() const { return read_scenario(parse_json(text()), directory_); }

  std::vector<SurfacePoint> points() const {
    const LoadedScenario loaded = scenario();
    return make_shell(loaded.scenario, loaded.files)->points();
  }

  /// The scale that makes an object, first read as millimetres, about as long as a tooth.
  double choose_scale(const Box& box, const char* object, const char* field) {
    const double longest = (box.max - box.min).maxCoeff() / 0.001, scale = guessed_scale(longest);
    notes_.push_back(
        fmt::format("longest edge of the {}'s box: {:.4g}, with scale {} {:.4g} mm; if it is not, change {}", object,
                    longest, scale, 1e3 * longest * scale, field));
    return scale;
  }

  void scale_environment() {
    const Box box = box_of(points());
    const double scale = choose_scale(box, "mesh", "environment.scale");
    values_["scale"] = scale;
    choose_tool((box.max - box.min).maxCoeff() / 0.001 * scale);
    values_["spacing"] = rounded(diameter_ / 10.0);
  }

  void choose_tool(double longest) {
    diameter_ = std::max(0.001, rounded(longest / 50.0));
    values_["diameter"] = diameter_;
    values_["length"] = 10.0 * diameter_;
  }

  void place_tool() {
    const std::vector<SurfacePoint> shell = points();
    const Box box = box_of(shell);
    longest_ = (box.max - box.min).maxCoeff();
    choose_tool(longest_);
    const Vec3 top = middle_of_the_top(shell, box.max.z(), 0.1 * diameter_);
    values_["z_pressed"] = to_micrometres(top.z() + 0.5 * diameter_ - kPressedBelow);
    if (has(kDrag)) {
      notes_.push_back(fmt::format("{} points", shell.size()));
      return choose_way(shell, {start_above(top), start_above(top_of_the_middle(shell, box, diameter_))});
    }
    start_at(start_above(top));
    notes_.push_back(fmt::format("{} points; the tool starts 1 mm above the highest, at x = {:.4g}, y = {:.4g} mm",
                                 shell.size(), 1e3 * top.x(), 1e3 * top.y()));
  }

  /// The start of a tool whose round tip is to land at `place`.
  Vec3 start_above(const Vec3& place) const {
    return {to_micrometres(place.x()), to_micrometres(place.y()),
            to_micrometres(place.z() + 0.5 * diameter_ + kClearance)};
  }

  void start_at(const Vec3& place) {
    values_["x"] = place.x();
    values_["y"] = place.y();
    values_["z"] = place.z();
  }

  /// Places the tool above the plane's middle, at a scale that makes it about as long as a tooth.
  void place_mesh_tool() {
    TriangleSoup surface = scenario().files.at(kToolFile).mesh().triangles();  // taken for millimetres
    const double scale = choose_scale(box_of(surface.vertices), "tool", "tool.scale");
    values_["tool_scale"] = scale;
    for (Vec3& vertex : surface.vertices) vertex *= scale / 0.001;
    const double touching = find_tip(surface);
    values_["z"] = to_micrometres(touching + kClearance);
    values_["z_pressed"] = to_micrometres(touching - kPressedBelow);
  }

  /// Takes the file's origin for the tip centre and -z for the tip's direction unless the tool then lies oddly; then
  /// guesses both. Returns how far the tool reaches beyond its tip centre [m].
  double find_tip(const TriangleSoup& surface) {
    const Box box = box_of(surface.vertices);
    const std::string odd = odd_frame(box);
    if (odd.empty()) {
      notes_.push_back(
          "taken for its tip centre: the file's origin, the tip pointing along -z; if it is not, change tool.tip_m and "
          "tool.tip_axis");
      return -box.min.z();
    }
    const auto [place, direction] = guess_tip(surface);
    const auto rounded_to = [](double digits, const Vec3& v) {
      Json json = Json::array();
      for (const double x : v) json.push_back(std::round(digits * x) / digits + 0.0);  // never -0
      return json;
    };
    values_["tip"] = rounded_to(1e6, place);
    values_["tip_axis"] = rounded_to(1e4, direction);
    notes_.push_back(fmt::format("with the file's origin for tip centre and the tip along -z the tool {}", odd));
    notes_.push_back(fmt::format(
        "taken for its tip: its thinner end, x = {:.4g}, y = {:.4g}, z = {:.4g} mm, pointing along {}; if it is not, change "
        "tool.tip_m and tool.tip_axis",
        1e3 * place.x(), 1e3 * place.y(), 1e3 * place.z(), values_["tip_axis"].dump()));
    return 0.0;  // the place is on the plane that touches the tool
  }

  /// Drags over four fifths of the way to where the surface ends.
  void choose_way(const std::vector<SurfacePoint>& points, const std::vector<Vec3>& starts) {
    const DragStart drag = choose_drag(PointShell(points, 0.0), starts, 0.5 * diameter_, 0.25 * longest_);
    const double way = 0.8 * drag.room, speed = kDragSpeed * diameter_;
    const bool has_room = way >= diameter_;
    start_at(drag.position);
    values_["dx"] = static_cast<int>(drag.direction.x());
    values_["dy"] = static_cast<int>(drag.direction.y());
    values_["speed"] = rounded(speed);
    values_["smoothing"] = drag.smoothing;
    const double seconds = (has_room ? way : 0.25 * longest_) / speed;
    values_["steps"] = static_cast<std::int64_t>(std::ceil(rounded(seconds) / kStep));
    if (!has_room) {
      warnings_.push_back(
          fmt::format("no way longer than {} was found over the surface along x or y, from its highest place or its "
                      "middle: set hand.path_m to points on the surface, or initial.position_m and hand.direction",
                      length_text(drag.room)));
      return;
    }
    notes_.push_back(fmt::format(
        "dragged from x = {:.4g}, y = {:.4g} mm on along [{}, {}, 0] for {}; the surface ends or turns after {}",
        1e3 * drag.position.x(), 1e3 * drag.position.y(), values_["dx"].dump(), values_["dy"].dump(), length_text(way),
        length_text(drag.room)));
  }

  void choose_stroke_steps() {
    const LoadedScenario loaded = scenario();
    const auto stroke = loaded.files.at(kMotionFile).stroke();
    const auto samples = stroke->motion.samples();
    const auto lower = [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); };
    const double lowest = std::min_element(samples.begin(), samples.end(), lower)->position.z();
    const double last = samples.back().time;
    values_["steps"] = static_cast<std::int64_t>(std::max(1.0, std::ceil(last / kStep) + 1.0));
    notes_.push_back(
        fmt::format("the stroke lasts from {:.4g} to {:.4g} s; its lowest tip is at z = {:.4g} mm, the "
                    "plane at 0",
                    samples.front().time, last, 1e3 * lowest));
  }

  std::string description_;
  std::string sections_;
  fs::path directory_;
  double diameter_ = 0.001;  ///< [m]
  double longest_ = 0.0;     ///< edge of the environment's box [m]
  Values values_ = {{"x", 0.0},
                    {"y", 0.0},
                    {"z", 0.0},
                    {"z_pressed", 0.0},
                    {"scale", 0.001},
                    {"tool_scale", 0.001},
                    {"tip", {0, 0, 0}},
                    {"tip_axis", {0, 0, -1}},
                    {"spacing", nullptr},
                    {"diameter", 0.001},
                    {"length", 0.01},
                    {"dx", 1},
                    {"dy", 0},
                    {"speed", 0.005},
                    {"smoothing", 0.0005}};
  std::vector<std::string> notes_, warnings_;
};

}  // namespace

const std::vector<StartKind>& start_kinds() {
  using enum StartSource;
  static const std::vector<StartKind> kinds = {
      {"mesh", "a drill is pressed on a surface from a file: OBJ, PLY, STL or OFF", mesh, true,
       kMesh + kAbove + kPress},
      {"shell", "a drill is pressed on points with normals from a file: CSV or PLY", shell, true,
       kShell + kAbove + kPress},
      {"drag", "a drill is dragged over a surface with 1 N along its normal", mesh, false, kPlane + kAbove + kDrag},
      {"bur", "a ball bur is dragged over a surface with 1 N along its normal", mesh, false,
       kPlane + kBurAbove + kDrag},
      {"tool", "a tool from a mesh file is pressed on a plane: OBJ, PLY, STL or OFF, closed", mesh, true,
       kPlane + kMeshToolAbove + kPress},
      {"plane", "a drill is pressed on a plane", none, false, kPlane + kAbove + kPress},
      {"hole", "a drill is turned to and fro in a drilled hole", none, false, kBlock + kInHole + kTurn},
      {"springs", "a point mass between springs", none, false, kSprings},
      {"stroke", "a recorded stroke over a plane is played back, from a CSV file", stroke, true, kPlane + kStroke},
      {"target", "a simulated subject leads a drill to targets in a hole", none, false, kBlock + kInHole + kTrack,
       40'000},
  };
  return kinds;
}

ScenarioStart scenario_start(const StartKind& kind, const std::optional<fs::path>& source, const fs::path& directory) {
  return Start(kind, source, directory).result();
}

}  // namespace hapbench
