#include "scenarios/program/new/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/rounding.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/new/drag_start.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/clock_coverage.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/mesh/half_edge_mesh.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {
namespace {

constexpr double kClearance = 0.001;  ///< distance between tool and surface at the start [m]
/// Smallest distance from the surface at which the tool may start or pass an obstacle [m]. Above a slope, the distance
/// is smaller than kClearance.
constexpr double kMinClearance = 0.5 * kClearance;
constexpr double kDragSpeed = 5.0;  ///< speed of a drag [tool diameters per second]
/// Waiting time at the end of a requested path, so that the tool reaches the hand's target [s]. While the tool lands
/// and climbs, it lags behind the target by millimetres, because the hand's spring has 300 N/m.
constexpr double kArrival = 0.5;
constexpr double kPressDepth = 0.0035;  ///< depth of a pressing hand's target below the surface [m]; gives 1 N

/// Rounds to two significant digits, for lengths that people read.
double rounded(double value) {
  return rounded_to_digits(value, 2);
}

Json list_of(const Vec3& v) {
  return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0};  // never -0
}

/// Rounds a length to the micrometre, for positions that people read.
double to_micrometres(double metres) {
  return std::round(1e6 * metres) / 1e6;
}

/// Returns the distance between two positions [m].
double distance_between(const Vec3& a, const Vec3& b) {
  return (a - b).norm();
}

/// Returns the point that is nearest to `position`. Precondition: there is a point.
const SurfacePoint& nearest_to(const Vec3& position, const std::vector<SurfacePoint>& points) {
  const auto distance = [&](const SurfacePoint& point) { return (point.position - position).squaredNorm(); };
  return *std::ranges::min_element(points, {}, distance);
}

/// Makes a scene for a scenario file in `directory`, and determines its values one after the other. Positions are
/// computed in the frame of the side from which the tool approaches (--side). The direction of the side is the z axis
/// of this frame. Throws InputError if a file cannot be used.
class Start {
 public:
  Start(const StartKind& kind, const NewOptions& options, const std::filesystem::path& directory)
      : scene_(kind.scene), options_(options), kind_(kind), directory_(directory) {
    for (const LengthUnit& unit : kLengthUnits)
      if (options.unit == unit.name) unit_ = unit.metres;
    if (!options.extent.empty()) extent_ = parse_length("--extent", options.extent);
    for (const std::string& point : options.path) requested_points_.push_back(parse_position("--path", point));
    if (!options.at.empty()) requested_points_.push_back(parse_position("--at", options.at));
    const bool is_on_mesh =
        !options.on.empty() || (kind.source == "mesh" && kind.is_source_optional && !options.from.empty());
    if (is_on_mesh) scene_["environment"] = kind_named("mesh").scene.at("environment");
    rotate_to_side();
    name_files();
    const bool is_placed = scene_.contains("initial") && scene_["initial"]["position_m"].is_null();
    if (is_placed) scene_["initial"]["position_m"] = {0, 0, 0};
    if (has_type("environment", "mesh")) scale_environment();
    if (has_type("environment", "point_shell")) check_shell_size();
    if (has_type("tool", "mesh")) {
      place_mesh_tool();
    } else if (is_placed) {
      place_tool();
      warn_of_start();
    }
    if (follows_path()) {
      place_path();
      warn_of_start();
    }
    if (kind.source == "stroke") choose_stroke_steps();
    if (has_type("environment", "mesh")) note_mesh();
  }

  StartedScene result() const { return {scene_, notes_, warnings_}; }

 private:
  bool has_type(const char* part, const char* type) const {
    return scene_.contains(part) && scene_.at(part).value(kTypeField, "") == type;
  }

  /// Returns true if the tool's positions are prescribed along a path.
  bool follows_path() const {
    const Json::json_pointer type("/motion/position/type");
    return scene_.contains(type) && scene_.at(type) == "prescribed";
  }

  /// Writes the names of the source file and of the mesh below a stroke into the fields that need them.
  void name_files() {
    for (const auto& [field, file] : {std::pair{"/environment/file", mesh_file()},
                                      {"/tool/file", options_.from},
                                      {"/motion/position/file", options_.from}}) {
      const Json::json_pointer pointer(field);
      if (!scene_.contains(pointer)) continue;
      if (std::filesystem::is_fifo(file))
        fail_in_file(file, "is a pipe; allowed: a file, because the scenario names it for later runs");
      scene_[pointer] = std::filesystem::proximate(file, directory_.empty() ? "." : directory_).generic_string();
    }
  }

  /// Sets the rotation from the side's frame to the world frame, and orients the tool along the side's axis.
  void rotate_to_side() {
    const auto axis = static_cast<Eigen::Index>(options_.side.back() - 'x');
    const Vec3 up = side_sign() * Vec3::Unit(axis), lean = Vec3::Unit(axis == 0 ? 1 : 0);
    to_world_ << lean, up.cross(lean), up;
    if (options_.side != "z" && (has_type("hand", "impedance") || follows_path()))
      scene_["motion"]["orientation"] = {{"up", list_of(up)}, {"lean", list_of(lean)}};
  }

  /// Returns the file of --on, or the file of --from if --on is not given: the mesh or point shell of the environment,
  /// or the mesh of the tool.
  const std::string& mesh_file() const { return options_.on.empty() ? options_.from : options_.on; }

  LoadedScenario scenario() const { return read_scenario(scene_, directory_); }

  std::shared_ptr<const PointShell> shell() const {
    const LoadedScenario loaded = scenario();
    return make_shell(loaded.scenario, loaded.files);
  }

  /// Returns the points over which the tool starts, in the side's frame. These are the points of the largest component
  /// if is_over_largest_, otherwise all points.
  std::vector<SurfacePoint> points() const {
    return in_frame_of_side(is_over_largest_ ? largest_component().points() : shell()->points());
  }
  std::vector<SurfacePoint> all_points() const { return in_frame_of_side(shell()->points()); }

  std::vector<SurfacePoint> in_frame_of_side(std::vector<SurfacePoint> points) const {
    for (SurfacePoint& point : points)
      point = {to_world_.transpose() * point.position, to_world_.transpose() * point.normal};
    return points;
  }

  /// Returns the command line of this `hapbench new` with an additional option, as an error message shows it.
  std::string quoted_command(const std::string& option) const {
    return fmt::format("\"{}\"", command_with(options_, option));
  }

  /// Returns the length of the file's unit [m]. With --unit, this is the given unit. With --extent, it is the unit
  /// with which the longest side of the object's bounding box is as long as given. With neither option, it is 1 m.
  /// `box`: the object's bounds, read as millimetres. Throws InputError if neither option is given and the object, read
  /// in metres, is shorter than 1 mm or longer than 1 m.
  double choose_scale(const Box& box, const char* object) {
    const double longest = box.size().maxCoeff() / 0.001;
    if (!extent_ && !unit_ && (longest < kShortestObject || longest > kLongestObject)) {
      throw InputError(fmt::format(
          "{}: the {} is {} long if its numbers are metres, {} if they are millimetres; allowed: {} ... {}, or to "
          "state its unit: {} or {}",
          mesh_file(), object, length_text(longest), length_text(0.001 * longest), length_text(kShortestObject),
          length_text(kLongestObject), quoted_command("--unit mm"), quoted_command("--unit m")));
    }
    const double scale = unit_ ? *unit_ : extent_ ? rounded_to_digits(*extent_ / longest, 6) : 1.0;
    notes_.push_back(fmt::format("longest edge of the {}'s bounding box: {:.6g} in the file, {} with scale {}{}",
                                 object, longest, length_text(longest * scale), scale, scale_note(scale)));
    return scale;
  }

  /// Returns the difference of the scale from the closest unit as text; empty if the difference is more than 20 %.
  static std::string scale_note(double scale) {
    const auto distance = [scale](const LengthUnit& unit) { return std::abs(scale / unit.metres - 1.0); };
    const LengthUnit& unit = *std::ranges::min_element(kLengthUnits, {}, distance);
    if (distance(unit) > 0.2) return "";
    if (distance(unit) < 1e-9) return fmt::format(" (the file is in {})", unit.name);
    return fmt::format(", {:.2g} % {} than in {} (--unit {} keeps its size)", 100.0 * distance(unit),
                       scale > unit.metres ? "larger" : "smaller", unit.name, unit.name);
  }

  /// Throws InputError if the point shell is shorter than 1 mm or longer than 1 m, because its file may not be in
  /// metres. Does not throw if --unit m confirms the size.
  void check_shell_size() {
    const double longest = bounds_of(points()).size().maxCoeff();
    const bool has_size = longest > 0.0;  // unlike a single point
    if (unit_ || !has_size || (longest >= kShortestObject && longest <= kLongestObject)) return;
    throw InputError(fmt::format(
        "{}: the shell is {} long if its numbers are metres, {} if they are millimetres; allowed: {} ... {} (convert "
        "the coordinates of the file to metres), or to confirm its size: {}",
        mesh_file(), length_text(longest), length_text(0.001 * longest), length_text(kShortestObject),
        length_text(kLongestObject), quoted_command("--unit m")));
  }

  MeshFile mesh() const { return scenario().files.at(kEnvironmentFile).mesh(); }

  /// Returns the largest component of the mesh. Computes it again only if the fields of the environment have changed
  /// since the last call. Precondition: the scale is set.
  const MeshFile& largest_component() const {
    const Json& environment = scene_.at("environment");
    if (!largest_ || environment != largest_environment_) {
      largest_ = mesh().largest_component();
      largest_environment_ = environment;
    }
    return *largest_;
  }

  /// Returns the bounding box of the environment's mesh in the side's frame. Leaves out specks, the components whose
  /// diameter is at most kSpeckSize times the diameter of the largest component.
  Box box_of_mesh() {
    const MeshFile file = mesh();
    const MeshFindings& found = file.findings();
    const std::size_t large = components_above_speck_size(found);
    if (large == found.component_count) return bounds_of(all_points());
    Box box = Box::nothing();
    for (std::size_t i = 0; i < large; ++i) {
      const Box& part = found.components[i].box;
      const Vec3 a = to_world_.transpose() * part.min, b = to_world_.transpose() * part.max;
      box.add(a.cwiseMin(b));
      box.add(a.cwiseMax(b));
    }
    notes_.push_back(fmt::format("measured without {} of {} components, which are specks",
                                 found.component_count - large, found.component_count));
    return box;
  }

  /// Scales the mesh, and chooses the spacing of its points. If no stroke moves the tool, chooses the tool's size by
  /// the size of the mesh.
  void scale_environment() {
    const Box box = box_of_mesh();
    const double scale = choose_scale(box, "mesh");
    scene_["environment"]["scale"] = scale;
    if (options_.on.empty()) choose_tool(box.size().maxCoeff() / 0.001 * scale);
    scene_["environment"]["spacing_m"] = rounded(diameter_ / 10.0);
    if (!options_.on.empty())
      notes_.push_back(fmt::format("the mesh: {}", bounds_text(Box{box.min / 0.001 * scale, box.max / 0.001 * scale})));
    is_over_largest_ = options_.on.empty() && requested_points_.empty() && mesh().findings().component_count > 1;
  }

  /// Adds notes on the components, the normals and the points of the mesh.
  void note_mesh() {
    if (is_over_largest_ || leaves_largest_)
      notes_.push_back(fmt::format("the mesh has {} components; the tool {}", mesh().findings().component_count,
                                   is_over_largest_
                                       ? "starts over the largest"
                                       : "has no room over the largest, and therefore starts over the whole mesh"));
    if (scene_["environment"].contains("flip_normals"))
      notes_.push_back(
          fmt::format("its normals point away from side {} and are inverted (environment.flip_normals); or "
                      "press from the other side with --side={}",
                      options_.side, other_side()));
    notes_.push_back(fmt::format("{} points with a spacing of {}, a tenth of the tool's diameter", shell()->size(),
                                 length_text(scene_["environment"]["spacing_m"].get<double>())));
  }

  /// Sets the tool's diameter to a fiftieth of the object's largest dimension `longest` [m], but at least 1 mm. Sets
  /// the tool's length to ten diameters.
  void choose_tool(double longest) {
    diameter_ = std::max(0.001, rounded(longest / 50.0));
    for (const auto& [field, size] : {std::pair{"diameter_m", diameter_}, {"length_m", 10.0 * diameter_}})
      if (scene_.contains("tool") && scene_["tool"].contains(field)) scene_["tool"][field] = size;
  }

  /// Returns the points of the surface. If the normals around the highest point of an open mesh point away from the
  /// side of --side, flips all normals of the mesh. If the normals of a point shell do so, throws InputError.
  std::vector<SurfacePoint> points_facing_side() {
    std::vector<SurfacePoint> shell = points();
    const Box box = bounds_of(shell);
    choose_tool(box.size().maxCoeff());
    const Vec3 top = top_center(shell, box.max.z(), 0.1 * diameter_).position;
    const bool is_open = !has_type("environment", "mesh") || !largest_component().open_edges().empty();
    // Sum the normals around the top along the side's axis; a negative sum means that the normals point away from the
    // side.
    double facing = 0.0;
    for (const SurfacePoint& point : shell) {
      const Vec3 from_top = point.position - top;
      // Skip points on the far side of a thin wall.
      if (from_top.norm() <= 0.5 * diameter_ && from_top.z() >= -0.1 * diameter_) facing += point.normal.z();
    }
    if (facing >= 0.0 || !is_open) return shell;
    if (!has_type("environment", "mesh")) {
      throw InputError(
          fmt::format("--from {}: its normals point away from side {}; allowed: inverted normals, or --side={}",
                      std::filesystem::path(options_.from).generic_string(), options_.side, other_side()));
    }
    scene_["environment"]["flip_normals"] = true;
    return points();
  }

  /// Throws InputError if a point of --at or --path is further from the bounding box of the surface than the box is
  /// large: its coordinates are then in another unit or in another frame. Also if a point of --path is repeated. `box`:
  /// in the side's frame.
  void check_requested_points(const Box& box) const {
    const char* const option = options_.at.empty() ? "--path" : "--at";
    for (std::size_t i = 0; i < requested_points_.size(); ++i) {
      const double distance = distance_to(box, to_world_.transpose() * requested_points_[i]);
      if (distance > diagonal(box))
        fail_in_option(option,
                       fmt::format("got a point {} away from the surface, which is {} large; allowed: metres, in "
                                   "the frame of the scene (\"hapbench validate\" prints the bounds)",
                                   length_text(distance), size_text(box)));
      if (i > 0 && requested_points_[i] == requested_points_[i - 1])
        fail_in_option(option, fmt::format("got point {} twice; allowed: points that differ", i));
    }
  }

  /// Returns an option and its value that gave a requested point, such as "--at 0,0,0.01".
  std::string point_option(std::size_t i) const {
    return options_.at.empty() ? "--path " + options_.path[i] : "--at " + options_.at;
  }

  /// Returns the largest distance between a requested point and the surface for which the point counts as near the
  /// surface [m]: the tool's width or three point spacings, whichever is larger. `at`: the point of the shell that is
  /// nearest to the requested point; the spacing is its distance from the nearest other point.
  double near_distance(const Vec3& at, const std::vector<SurfacePoint>& shell) const {
    double spacing = std::numeric_limits<double>::infinity();
    for (const SurfacePoint& point : shell)
      if (point.position != at) spacing = std::min(spacing, distance_between(point.position, at));
    return std::max(diameter_, 3.0 * spacing);
  }

  /// Warns about points of --at or --path that are not near the surface (near_distance()).
  void warn_of_far_points(const std::vector<SurfacePoint>& shell) {
    for (std::size_t i = 0; i < requested_points_.size(); ++i) {
      const Vec3 point = to_world_.transpose() * requested_points_[i];
      const Vec3 nearest = nearest_to(point, shell).position;
      const double distance = distance_between(point, nearest);
      if (distance <= near_distance(nearest, shell)) continue;
      const Vec3 world = to_world_ * nearest;
      warnings_.push_back(fmt::format(
          "{}: the point is {} away from the surface; the nearest surface point is {:.4g},{:.4g},{:.4g}: give points "
          "on the surface, in metres and in the frame of the scene (\"hapbench validate\" prints the bounds)",
          point_option(i), length_text(distance), world.x(), world.y(), world.z()));
    }
  }

  /// Places the tool above the surface, and sets the motion of the hand.
  void place_tool() {
    const std::vector<SurfacePoint> shell = points_facing_side();
    check_requested_points(bounds_of(shell));
    warn_of_far_points(shell);
    const SurfacePoint top = top_of(shell);
    if (!has_type("hand", "drag")) return press_on(start_points(shell, top));
    if (!has_type("environment", "mesh")) notes_.push_back(fmt::format("{} points", shell.size()));
    if (requested_points_.size() > 1) return follow_path(drag_start(top, shell));
    choose_drag_path(shell, top);
  }

  /// Selects all components instead of the largest, over which the tool has no room. The tool must then be placed
  /// again.
  void leave_largest() {
    is_over_largest_ = false;
    leaves_largest_ = true;
    scene_["environment"].erase("flip_normals");
  }

  /// Returns surface points above which the tool may start, the preferred point first. If other components may be in
  /// the way, these are also the highest points around nine positions on the largest component.
  std::vector<SurfacePoint> start_points(const std::vector<SurfacePoint>& points, const SurfacePoint& top) const {
    if (!requested_points_.empty()) return {top};
    const Box box = bounds_of(points);
    std::vector<SurfacePoint> starts = {top, highest_at_center(points, box, diameter_)};
    constexpr std::array columns = {-1.0, 0.0, 1.0};
    for (std::size_t i = 0; is_over_largest_ && i < 9; ++i) {
      const Vec3 shift = 0.25 * box.size().cwiseProduct(Vec3(columns[i % 3], columns[i / 3], 0.0));
      starts.push_back(highest_at_center(points, {box.min + shift, box.max + shift}, diameter_));
    }
    return starts;
  }

  /// Places a tool that is pressed on the surface: above the first of the start points where the tool does not touch
  /// the surface. If there is no such point, the tool starts higher above the first start point.
  void press_on(const std::vector<SurfacePoint>& starts) {
    const PointShell shell(all_points(), 0.0);
    const LoadedScenario loaded = scenario();
    const auto tool = make_tool(loaded.scenario, loaded.files);
    const auto gap = [&](const Vec3& tip) { return gap_between(*tool, {tip, -Vec3::UnitZ(), 0.0}, shell).distance; };
    // Lowers the tool until its distance from the surface is between `distance` and kError above it.
    constexpr double kError = 2e-5;
    const auto lowered = [&gap](Vec3 tip, double distance) {
      for (double now = gap(tip); now > distance + kError; now = gap(tip)) tip.z() -= now - distance;
      return tip;
    };
    const auto is_free = [&](const SurfacePoint& point) {
      const double distance = gap(start_above(point.position));
      return distance >= kMinClearance && distance <= kClearance + kError;  // the centre of a ring is too far away
    };
    const auto free = std::ranges::find_if(starts, is_free);
    const bool is_blocked = free == starts.end();
    if (is_blocked && is_over_largest_) {
      leave_largest();
      return place_tool();
    }
    const SurfacePoint& top = is_blocked ? starts.front() : *free;
    Vec3 start = start_above(top.position), landing = top.position + 0.5 * diameter_ * Vec3::UnitZ();
    if (is_blocked) {
      const double above_all = shell.bounds().max.z() + 0.5 * diameter_ + kClearance;
      start = lowered({start.x(), start.y(), above_all}, kClearance);
      landing = lowered(start, 0.0);
      warn_of_raised_start(top, start.z() - start_above(top.position).z());
    }
    press_target_ = to_micrometres(side_sign() * (landing.z() - kPressDepth));
    start_at({start.x(), start.y(), to_micrometres(start.z())});
    note_press(top.position, gap(start), is_blocked, shell);
  }

  /// Adds a note on the start of a tool that is pressed on the surface. `gap`: distance between tool and surface [m].
  void note_press(const Vec3& top, double gap, bool is_raised, const PointShell& shell) {
    const std::string count = has_type("environment", "mesh") ? "" : fmt::format("{} points; ", shell.size());
    const bool is_on_top =
        options_.side == "z" && !is_raised && to_micrometres(top.z()) >= to_micrometres(shell.bounds().max.z());
    const std::string where =
        is_raised ? "off the surface, with its tip centre at " + hapbench::position_text(start_)
                  : fmt::format("{} {}", is_on_top ? "above the highest point, at" : "off the surface at",
                                position_text(top, !is_on_top));
    notes_.push_back(fmt::format("{}the tool starts {} {}", count, length_text(rounded(gap)), where));
  }

  /// Warns that the tool starts higher by `rise` [m], and therefore does not land on `top`.
  void warn_of_raised_start(const SurfacePoint& top, double rise) {
    // An earlier warning already advises another point.
    if (requested_points_.empty() || !warnings_.empty()) return;
    const std::string side = side_of(top.normal);
    warnings_.push_back(fmt::format(
        "{}: a tool that starts 1 mm above this point touches the surface beside it; the tool starts {} higher, and "
        "may land on another point: choose another --at{}",
        point_option(0), length_text(rise), side == options_.side ? "" : ", or --side=" + side));
  }

  /// Warns if the tool starts in contact with the surface or behind it.
  void warn_of_start() {
    const SceneFacts facts = scene_facts(scenario());
    if (!facts.surface) return;
    const Gap& gap = facts.surface->start;
    const bool is_behind = std::ranges::count(facts.warnings, "wrong_side", &Warning::kind) > 0;
    if (gap.touching == 0 && !is_behind) return;
    const std::string problem = gap.touching == 0
                                    ? "behind the surface, on the side opposite to its normals"
                                    : fmt::format("in contact: {} points inside the tool, largest depth {}",
                                                  gap.touching, length_text(-gap.distance));
    warnings_.push_back(fmt::format("the tool starts {}; its tip centre is at {}: choose another start with {}",
                                    problem, hapbench::position_text(start_),
                                    placement_options(options_, kind_).text()));
  }

  /// Returns a position as text [mm], in the world frame.
  std::string position_text(const Vec3& position, bool with_height) const {
    const Vec3 world = to_world_ * position;
    return fmt::format("x = {:.4g}, y = {:.4g}{} mm", 1e3 * world.x(), 1e3 * world.y(),
                       with_height ? fmt::format(", z = {:.4g}", 1e3 * world.z()) : "");
  }

  /// Returns the value of --side for the axis closest to a direction in the side's frame.
  std::string side_of(const Vec3& direction) const {
    const Vec3 world = to_world_ * direction;
    Eigen::Index axis = 0;
    world.cwiseAbs().maxCoeff(&axis);
    return (world[axis] < 0.0 ? "-" : "") + std::string(1, "xyz"[axis]);
  }

  /// Returns the value of --side for the opposite side.
  std::string other_side() const {
    return options_.side.front() == '-' ? options_.side.substr(1) : "-" + options_.side;
  }

  double side_sign() const { return options_.side.front() == '-' ? -1.0 : 1.0; }

  /// Returns the surface point above which the tool starts. Without requested points, it is the middle of the top.
  /// Otherwise it is the surface point that is nearest to the first requested point and whose normal points to the
  /// side. If this point is not near the requested point, a path starts at the nearest point with any normal, and --at
  /// causes a warning.
  SurfacePoint top_of(const std::vector<SurfacePoint>& shell) {
    if (requested_points_.empty()) return top_center(shell, bounds_of(shell).max.z(), 0.1 * diameter_);
    const Vec3 named = to_world_.transpose() * requested_points_.front();
    const auto distance = [&named](const SurfacePoint& point) {
      return point.normal.z() > 0.0 ? distance_between(point.position, named) : std::numeric_limits<double>::infinity();
    };
    SurfacePoint facing = *std::ranges::min_element(shell, {}, distance), nearest = nearest_to(named, shell);
    const double limit = near_distance(nearest.position, shell);
    if (distance(facing) <= limit) return facing;
    if (requested_points_.size() > 1) return nearest;
    if (distance_between(nearest.position, named) <= limit)
      warnings_.push_back(fmt::format(
          "{}: the surface at this point does not face side {}; the tool starts over a point {} away, which faces this "
          "side: choose another --at, or --side={}",
          point_option(0), options_.side, length_text(distance(facing)), side_of(nearest.normal)));
    return facing;
  }

  /// Returns the start position from which a tool with a round tip lands at `position`.
  Vec3 start_above(const Vec3& position) const {
    return {to_micrometres(position.x()), to_micrometres(position.y()),
            to_micrometres(position.z() + 0.5 * diameter_ + kClearance)};
  }

  /// Returns the start position of a drag. On a steep surface, where a tool above the point would touch the surface,
  /// the tool starts beside the point, in the direction of the normal.
  Vec3 drag_start(const SurfacePoint& point, const std::vector<SurfacePoint>& shell) const {
    const auto tip_gap = [&](const Vec3& tip) {
      return distance_between(nearest_to(tip, shell).position, tip) - 0.5 * diameter_;
    };
    Vec3 above = start_above(point.position);
    if (tip_gap(above) >= kMinClearance) return above;
    const Vec3 beside = (point.position + (0.5 * diameter_ + kClearance) * point.normal).unaryExpr(&to_micrometres);
    return tip_gap(beside) > tip_gap(above) ? beside : above;
  }

  /// Sets the initial position. A pressing hand moves its target along the side's axis below the surface.
  void start_at(const Vec3& position) {
    start_ = to_world_ * position;
    const Json world = list_of(start_);
    scene_["initial"]["position_m"] = world;
    if (!has_type("hand", "impedance")) return;
    Json& target = scene_["hand"]["target"];
    target = {{"x_m", world[0]}, {"y_m", world[1]}, {"z_m", world[2]}};
    Json& along = target[std::string(1, options_.side.back()) + "_m"];
    along = {{kTypeField, "waypoints"},
             {"points", Json::array({Json::array({0, along}), Json::array({0.5, press_target_})})},
             {"interpolation", "cosine"}};
  }

  /// Drags the tool along the requested points. `start`: start position.
  void follow_path(const Vec3& start) {
    double length = 0.0;
    Json& hand = scene_["hand"];
    hand.erase("direction");
    for (const Vec3& point : requested_points_) hand["path_m"].push_back(list_of(point));
    for (std::size_t i = 1; i < requested_points_.size(); ++i)
      length += (requested_points_[i] - requested_points_[i - 1]).norm();
    start_at(start);
    set_drag_duration(length, kArrival);
    hand["smoothing_m"] = 0.5 * diameter_;
    notes_.push_back(fmt::format("dragged along a path of {}", length_text(length)));
  }

  /// Sets the speed of a drag, and enough steps for a path of this length [m] and the time after its end [s].
  void set_drag_duration(double length, double rest = 0.0) {
    const double speed = kDragSpeed * diameter_;
    scene_["hand"]["speed_m_per_s"] = rounded(speed);
    scene_["time"]["steps"] = static_cast<std::int64_t>(std::ceil((rounded(length / speed) + rest) / kStartStep));
  }

  /// Places a mesh tool above the middle of the plane. The tip centre is the origin of the file, which is the
  /// default of the format.
  void place_mesh_tool() {
    const TriangleSoup surface = scenario().files.at(kToolFile).mesh().triangles();  // read as millimetres
    Box box = box_of(surface.vertices);
    const double scale = choose_scale(box, "tool");
    scene_["tool"]["scale"] = scale;
    box = {scale / 0.001 * box.min, scale / 0.001 * box.max};
    notes_.emplace_back(
        "assumed tip centre: the file's origin, with the tip pointing along -z; tool.tip_m and tool.tip_axis change "
        "this");
    if (const std::string odd = frame_problem(box); !odd.empty())
      warnings_.push_back(fmt::format("the tool {}: set tool.tip_m and tool.tip_axis", odd));
    press_target_ = to_micrometres(-box.min.z() - kPressDepth);
    start_at({0.0, 0.0, to_micrometres(-box.min.z() + kClearance)});
  }

  /// Returns the points of the components over which the tool does not start; no points if it starts over all.
  PointShell other_components() const {
    std::vector<SurfacePoint> others;
    if (is_over_largest_) {
      const TriangleSoup largest = largest_component().triangles();
      const TriangleTree tree(largest.vertices, largest.triangles);
      constexpr double kRounding = 1e-9;
      for (const SurfacePoint& point : shell()->points())
        if (!tree.nearest(point.position, kRounding)) others.push_back(point);
    }
    return {in_frame_of_side(others), 0.0};
  }

  /// Returns the length of a path up to the first position where the tool is too close to `obstacles` [m]. Tests
  /// positions one tool diameter apart, and the start above the path.
  double unobstructed_length(const SurfacePath& path, const ToolShape& tool, const PointShell& obstacles) const {
    if (obstacles.size() == 0) return path.length();
    const auto is_free = [&](double s, double height) {
      const SurfacePoint foot = path.at(s);
      const Vec3 axis = has_type("hand", "drag") ? tool_axis({foot.normal, path.direction(s), {}, {}},
                                                             scene_.at("hand").at("tilt_rad").get<double>(), 0.0)
                                                 : Vec3(-Vec3::UnitZ());
      const ToolPose pose{foot.position + (0.5 * diameter_ + height) * foot.normal, axis, 0.0};
      return gap_between(tool, pose, obstacles).distance >= kMinClearance;
    };
    if (!is_free(0.0, kClearance)) return 0.0;
    for (double s = 0.0; s <= path.length(); s += diameter_)
      if (!is_free(s, 0.0)) return std::max(0.0, s - diameter_);
    return path.length();
  }

  /// Chooses the start and direction of a path over the surface, on which the tool stays free of other components.
  /// Searches a path of at least a quarter of the surface's extent. `top`: surface point above which the path may
  /// start.
  DragStart free_drag(const std::vector<SurfacePoint>& points, const SurfacePoint& top) const {
    std::vector<Vec3> starts;
    for (const SurfacePoint& point : start_points(points, top)) starts.push_back(drag_start(point, points));
    const LoadedScenario loaded = scenario();
    const auto tool = make_tool(loaded.scenario, loaded.files);
    const PointShell obstacles = other_components();
    return choose_drag(PointShell(points, 0.0), starts, 0.5 * diameter_, 0.25 * bounds_of(points).size().maxCoeff(),
                       [&](const SurfacePath& path) { return unobstructed_length(path, *tool, obstacles); });
  }

  /// Chooses the start and direction of a drag. The drag covers four fifths of the path to the end of the surface.
  void choose_drag_path(const std::vector<SurfacePoint>& points, const SurfacePoint& top) {
    const DragStart drag = free_drag(points, top);
    const double length = 0.8 * drag.free_length;
    const bool has_room = length >= diameter_;
    if (!has_room && is_over_largest_) {
      leave_largest();
      return place_tool();
    }
    start_at(drag.position);
    // Write the drag into the scene.
    const Vec3 direction = to_world_ * drag.direction;
    Json along = Json::array();
    for (const double part : direction) along.push_back(static_cast<int>(part));
    scene_["hand"]["direction"] = along;
    scene_["hand"]["smoothing_m"] = drag.smoothing;
    set_drag_duration(has_room ? length : 0.25 * bounds_of(points).size().maxCoeff());
    if (!has_room) {
      warnings_.push_back(fmt::format(
          "no path longer than {} was found over the surface along x or y, from its highest point or its middle: set "
          "hand.path_m to points on the surface, or initial.position_m and hand.direction",
          length_text(drag.free_length)));
      return;
    }
    notes_.push_back(fmt::format("dragged from {} along [{}, {}, {}] for {}; {} after {}",
                                 position_text(drag.position, options_.side != "z" || !requested_points_.empty()),
                                 along[0].dump(), along[1].dump(), along[2].dump(), length_text(length),
                                 drag.is_blocked ? "another component is in the way" : "the surface ends or turns",
                                 length_text(drag.free_length)));
  }

  /// Returns the path over the surface that the tool follows, in the side's frame: over the requested points, or where
  /// a drag would go.
  SurfacePath surface_path() {
    const std::vector<SurfacePoint> points = points_facing_side();
    const PointShell shell(points, 0.0);
    check_requested_points(bounds_of(points));
    warn_of_far_points(points);
    if (!requested_points_.empty()) {
      std::vector<Vec3> legs;
      for (const Vec3& point : requested_points_) legs.emplace_back(to_world_.transpose() * point);
      return SurfacePath::over(SmoothedSurface(shell, 0.5 * diameter_), legs);
    }
    const DragStart drag = free_drag(points, top_of(points));
    if (drag.free_length < diameter_ && is_over_largest_) {
      leave_largest();
      return surface_path();
    }
    return SurfacePath::along(SmoothedSurface(shell, drag.smoothing), drag.position, drag.direction,
                              0.8 * drag.free_length);
  }

  /// Prescribes the tip's positions: from above the surface down to the depth of --depth below the surface, and then
  /// along the path at this depth.
  void place_path() {
    constexpr double kLanding = 0.25;     // duration of the approach [s]
    constexpr double kMaxPoints = 400.0;  // largest number of points of the path
    const SurfacePath path = surface_path();
    const double depth = options_.depth.empty() ? 0.1 * diameter_ : parse_length("--depth", options_.depth);
    if (!(depth < 0.5 * diameter_))
      fail_in_option("--depth", fmt::format("got {}; allowed: less than the radius of the tool, {}", options_.depth,
                                            length_text(0.5 * diameter_)));
    if (!(path.length() > 0.0))
      fail_in_option("--path", "got none, and no path was found over the surface; allowed: two points or more near it");
    const double speed = kDragSpeed * diameter_;
    const double count = std::clamp(std::ceil(path.length() / (0.1 * diameter_)), 1.0, kMaxPoints);
    std::array<Json, 3> waypoints{Json::array(), Json::array(), Json::array()};
    const auto add = [&](double time, double s, double height) {
      const SurfacePoint foot = path.at(s);
      const Vec3 position = to_world_ * Vec3(foot.position + (0.5 * diameter_ + height) * foot.normal);
      for (std::size_t k = 0; k < 3; ++k)
        waypoints[k].push_back(
            {rounded_to_digits(time, 6), 1e-7 * std::round(1e7 * position[static_cast<Eigen::Index>(k)])});
    };
    const SurfacePoint first = path.at(0.0);
    start_ = to_world_ * Vec3(first.position + (0.5 * diameter_ + kClearance) * first.normal);
    add(0.0, 0.0, kClearance);
    double time = kLanding;
    for (double i = 0.0; i <= count; ++i) {
      const double s = path.length() * i / count;
      add(time = kLanding + s / speed, s, -depth);
    }
    for (std::size_t k = 0; k < 3; ++k)
      scene_["motion"]["position"][std::string(1, "xyz"[k]) + "_m"] = {{kTypeField, "waypoints"},
                                                                       {"points", waypoints[k]}};
    scene_["time"]["steps"] = static_cast<std::int64_t>(std::ceil(time / kStartStep));
    notes_.push_back(fmt::format("a path of {}, {} below the surface; reference: frictionless rigid contact",
                                 length_text(path.length()), length_text(depth)));
  }

  /// Throws InputError for a stroke that no run can record. Its clock is probably in another unit.
  [[noreturn]] void refuse_long_stroke(const Stroke& stroke) const {
    TimeFields longest;
    longest.step = kStartStep;
    longest.steps = static_cast<std::int64_t>(kMaxRows);
    const auto warning = stroke_clock_warning(stroke, longest);
    fail_in_file(options_.from,
                 fmt::format("lasts until {:.4g} s; allowed: at most {:.4g} s{}{}", stroke.motion.samples().back().time,
                             kMaxRows * kStartStep, warning ? "; " : "", warning ? warning->text : ""));
  }

  /// Sets the number of steps to the duration of the stroke.
  void choose_stroke_steps() {
    const LoadedScenario loaded = scenario();
    const auto stroke = loaded.files.at(kMotionFile).stroke();
    const auto samples = stroke->motion.samples();
    const auto height = [](const auto& sample) { return sample.position.z(); };
    const double lowest = height(*std::ranges::min_element(samples, {}, height)), last = samples.back().time;
    const double steps = std::max(1.0, std::ceil(last / kStartStep) + 1.0);
    if (steps > kMaxRows) refuse_long_stroke(*stroke);
    scene_["time"]["steps"] = static_cast<std::int64_t>(steps);
    notes_.push_back(fmt::format("the stroke lasts from {:.4g} to {:.4g} s; its lowest tip position is z = {:.4g} mm{}",
                                 samples.front().time, last, 1e3 * lowest,
                                 options_.on.empty() ? ", with the plane at z = 0" : ""));
  }

  Json scene_;
  std::vector<std::string> notes_, warnings_;
  const NewOptions& options_;
  const StartKind& kind_;
  std::filesystem::path directory_;
  bool is_over_largest_ = false;        ///< the tool starts over the largest of several components of a mesh
  bool leaves_largest_ = false;         ///< the tool starts over the whole mesh instead, see leave_largest()
  std::optional<double> unit_;          ///< stated unit of the mesh file [m]
  std::optional<double> extent_;        ///< stated longest edge of the mesh's box [m]
  std::vector<Vec3> requested_points_;  ///< points of --path, or the point of --at [m]
  Mat3 to_world_ = Mat3::Identity();    ///< rotates vectors of the side's frame into the world frame
  double diameter_ = 0.001;             ///< diameter of the tool [m]
  /// Largest component of the mesh. Valid if the environment of the scene is equal to largest_environment_.
  mutable std::optional<MeshFile> largest_;
  mutable Json largest_environment_;
  double press_target_ = 0.0;  ///< final target of a pressing hand along the side's axis [m]
  Vec3 start_ = Vec3::Zero();  ///< position of the tip centre at the start, in the world frame [m]
};

}  // namespace

StartedScene started_scene(const StartKind& kind, const NewOptions& options, const std::filesystem::path& directory) {
  return Start(kind, options, directory).result();
}

}  // namespace hapbench
