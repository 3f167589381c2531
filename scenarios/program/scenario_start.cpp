#include "scenarios/program/scenario_start.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "sim/core/math.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// ---- Guesses from a mesh: the tip of a tool, and where a tool that comes along -z starts over it

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

// ---- A start

constexpr double kStep = 0.0005;          ///< [s]
constexpr double kClearance = 0.001;      ///< between tool and surface at the start [m]
constexpr double kDragSpeed = 5.0;        ///< in diameters of the tool [1/s]
constexpr double kPressedBelow = 0.0035;  ///< the hand's target, 1 N below the surface with kPress [m]

/// The values by their names @name@ in the templates.
using Values = std::map<std::string, Json>;

/// Rounds to two significant digits, as people write lengths.
double rounded(double value) {
  return std::stod(fmt::format("{:.2g}", value));
}

/// Puts a text in the place of each @name@.
void fill_mark(std::string& text, const std::string& name, const std::string& with) {
  const std::string mark = "@" + name + "@";
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += with.size())
    text.replace(at, mark.size(), with);
}

/// The box of things at a place each.
template <class Things, class Place = std::identity>
Box box_of(const Things& things, Place place = {}) {
  const Vec3 first = std::invoke(place, things.front());
  Box box{first, first};
  for (const auto& thing : things)
    box = {box.min.cwiseMin(std::invoke(place, thing)), box.max.cwiseMax(std::invoke(place, thing))};
  return box;
}

/// A unit that a file may have.
struct MeshUnit {
  double metres;
  const char* name;
};

/// Objects are worked on by tools of a millimetre and more, which are a hundredth to a third of them.
constexpr double kShortestObject = 0.003, kLongestObject = 0.3;  // [m]

/// How far the length in that unit is from those of such objects: 0 within, else the logarithm of the ratio.
double misfit(double length, const MeshUnit& unit) {
  return std::max(
      {0.0, math::log(kShortestObject / (length * unit.metres)), math::log(length * unit.metres / kLongestObject)});
}

/// The units in the order in which they are believed: by their misfit, then the usual ones first.
std::array<MeshUnit, 3> likely_units(double length) {
  std::array<MeshUnit, 3> units = {{{0.001, "mm"}, {1.0, "m"}, {0.01, "cm"}}};
  std::ranges::stable_sort(units, {}, [length](const MeshUnit& unit) { return misfit(length, unit); });
  return units;
}

/// Rounds to the micrometre, as people write places.
double to_micrometres(double metres) {
  return std::round(1e6 * metres) / 1e6;
}

/// A start that is being made: its values are determined one after the other. Places are found in the frame of the side
/// from which the tool comes, in which that is z.
class Start {
 public:
  Start(const StartKind& kind, const StartOptions& options, const fs::path& directory)
      : description_(kind.summary), sections_(kind.sections), options_(options), directory_(directory) {
    const bool is_on_mesh = options.on || (kind.source == StartSource::mesh && !kind.needs_source && options.source);
    if (is_on_mesh) sections_ = on_mesh(kind);
    turn_to_side();
    values_["steps"] = kind.steps;
    for (const Vec3& point : options.path) values_["path"].push_back({point.x(), point.y(), point.z()});
    if (options.source) values_["file"] = path_text(*options.source);
    if (options.on || options.source) values_["surface"] = path_text(options.on ? *options.on : *options.source);
    if (options.on) {
      scale_to_stroke();
    } else if (has("@scale@")) {
      scale_environment();
    }
    if (has("@tool_scale@")) {
      place_mesh_tool();
    } else if (has("@x@")) {
      place_tool();
    }
    if (kind.source == StartSource::stroke) choose_stroke_steps();
    note_spacing();
  }

  ScenarioStart result() const { return {text(), notes_, warnings_}; }

 private:
  bool has(const std::string& part) const { return sections_.find(part) != std::string::npos; }

  std::string path_text(const fs::path& file) const {
    return fs::proximate(file, directory_.empty() ? "." : directory_).generic_string();
  }

  /// Puts the side's axes in the place of x, y and z.
  void turn_to_side() {
    const auto axis = static_cast<Eigen::Index>(options_.side.back() - 'x');
    const Vec3 up = (options_.side.front() == '-' ? -1.0 : 1.0) * Vec3::Unit(axis);
    const Vec3 lean = Vec3::Unit(axis == 0 ? 1 : 0);
    to_world_ << lean, up.cross(lean), up;
    std::vector<std::string> targets;
    for (const char name : {'x', 'y', 'z'}) {
      targets.push_back(name - 'x' != axis
                            ? fmt::format("\"{0}_m\": @{0}@", name)
                            : fmt::format("\"{0}_m\": {{\"type\": \"waypoints\", \"points\": [[0, @{0}@], "
                                          "[0.5, @pressed@]], \"interpolation\": \"cosine\"}}",
                                          name));
    }
    fill_mark(sections_, "target", fmt::format("{}", fmt::join(targets, ",\n      ")));
    fill_mark(sections_, "way", options_.path.empty() ? "\"direction\": @direction@" : "\"path_m\": @path@");
    if (options_.side != "z" && has("\"impedance\"")) {
      const auto list = [](const Vec3& v) {
        return fmt::format("[{}, {}, {}]", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
      };
      sections_ +=
          fmt::format(",\n  \"motion\": {{\"orientation\": {{\"up\": {}, \"lean\": {}}}}}\n", list(up), list(lean));
    }
  }

  std::string text() const {
    std::string text = fmt::format("{{\n  \"description\": {},\n  \"time\": {{\"step_s\": {}, \"steps\": @steps@}},",
                                   Json(description_).dump(), kStep) +
                       sections_ + "}\n";
    fill_mark(text, "flip", flip_ ? ", \"flip_normals\": true" : "");
    for (const auto& [name, value] : values_) fill_mark(text, name, value.dump());
    return text;
  }

  LoadedScenario scenario() const { return read_scenario(parse_json(text()), directory_); }

  /// The points of the scene in the side's frame.
  std::vector<SurfacePoint> points() const {
    const LoadedScenario loaded = scenario();
    std::vector<SurfacePoint> points = make_shell(loaded.scenario, loaded.files)->points();
    for (SurfacePoint& point : points)
      point = {to_world_.transpose() * point.position, to_world_.transpose() * point.normal};
    return points;
  }

  /// The scale that was given, or that of the likeliest unit of an object that was first read as millimetres. Where
  /// another unit is possible, too, both readings are said.
  double choose_scale(const Box& box, const char* object) {
    const double longest = (box.max - box.min).maxCoeff() / 0.001;
    const auto reading = [longest](double scale) { return length_text(longest * scale); };
    std::string note = fmt::format("longest edge of the {}'s box: {:.4g}, ", object, longest);
    if (options_.scale) {
      notes_.push_back(note + fmt::format("with scale {} {}", *options_.scale, reading(*options_.scale)));
      return *options_.scale;
    }
    const auto [unit, other, last] = likely_units(longest);
    note += fmt::format("taken for {}: {}", unit.name, reading(unit.metres));
    constexpr double kDoubt = 1.3;  // ln(3.7): 0.8 mm to 1.1 m
    if (misfit(longest, other) < kDoubt)
      note += fmt::format("; in {} it would be {}: --scale {}", other.name, reading(other.metres), other.metres);
    notes_.push_back(note);
    return unit.metres;
  }

  void scale_environment() {
    const Box box = box_of(points(), &SurfacePoint::position);
    const double scale = choose_scale(box, "mesh");
    values_["scale"] = scale;
    choose_tool((box.max - box.min).maxCoeff() / 0.001 * scale);
    values_["spacing"] = rounded(diameter_ / 10.0);
  }

  /// Takes the unit in which the stroke comes into the mesh's box, of several the one that makes both alike in size.
  void scale_to_stroke() {
    const LoadedScenario loaded = scenario();  // in millimetres
    const Box box = box_of(loaded.files.at(kEnvironmentFile).mesh().triangles().vertices);
    const auto stroke = loaded.files.at(kMotionFile).stroke();
    std::vector<Vec3> places;
    for (const auto& sample : stroke->motion.samples()) places.push_back(sample.position);
    const Box way = box_of(places);
    const double size = std::max((way.max - way.min).norm(), kShortestObject);
    const auto gap_of = [&](double scale) {
      const Box scaled{box.min * (scale / 0.001), box.max * (scale / 0.001)};
      double gap = std::numeric_limits<double>::infinity();
      for (const Vec3& place : places) gap = std::min(gap, distance_to(scaled, place));
      return std::max(0.0, gap - 0.5 * diameter_);
    };
    const auto misfit_of = [&](double scale) {
      return gap_of(scale) / size + 0.1 * std::abs(math::log((box.max - box.min).norm() * (scale / 0.001) / size));
    };
    // Not std::ranges::min, which clang 14 does not compile.
    const double guessed =
        std::min({0.001, 1.0, 0.01}, [&](double a, double b) { return misfit_of(a) < misfit_of(b); });
    const double scale = options_.scale.value_or(guessed);
    values_["scale"] = scale;
    values_["spacing"] = 0.1 * diameter_;
    const Box scaled{box.min * (scale / 0.001), box.max * (scale / 0.001)};
    notes_.push_back(fmt::format("the mesh with scale {}: {}; the stroke: {}{}", scale, place_text(scaled),
                                 place_text(way),
                                 options_.scale ? "" : "; if that does not fit, --scale, or --shift of import"));
    if (const double gap = gap_of(scale); gap > 0.0)
      warnings_.push_back(fmt::format("the stroke stays {} away from the mesh", length_text(gap)));
  }

  void choose_tool(double longest) {
    diameter_ = std::max(0.001, rounded(longest / 50.0));
    values_["diameter"] = diameter_;
    values_["length"] = 10.0 * diameter_;
  }

  /// Turns the normals of an open mesh round that point away from the side, about its highest place.
  std::vector<SurfacePoint> facing_points() {
    std::vector<SurfacePoint> shell = points();
    const Box box = box_of(shell, &SurfacePoint::position);
    longest_ = (box.max - box.min).maxCoeff();
    choose_tool(longest_);
    const Vec3 top = middle_of_the_top(shell, box.max.z(), 0.1 * diameter_);
    const bool is_open = !has("@flip@") || !scenario().files.at(kEnvironmentFile).mesh().open_edges().empty();
    double facing = 0.0;
    for (const SurfacePoint& point : shell) {
      const Vec3 from_top = point.position - top;
      // Not those of the far side of a thin wall.
      if (from_top.norm() <= 0.5 * diameter_ && from_top.z() >= -0.1 * diameter_) facing += point.normal.z();
    }
    if (facing >= 0.0 || !is_open) return shell;
    const std::string side = options_.side.front() == '-' ? options_.side.substr(1) : "-" + options_.side;
    const std::string found = fmt::format("its normals point away from side {}", options_.side);
    if (!has("@flip@")) {
      throw InputError(fmt::format("--from {}: {}; allowed: normals turned round, or --side={}",
                                   values_.at("surface").get<std::string>(), found, side));
    }
    flip_ = true;
    notes_.push_back(fmt::format(
        "{} and are turned round, environment.flip_normals; or press from the other side: --side={}", found, side));
    return points();
  }

  void place_tool() {
    const std::vector<SurfacePoint> shell = facing_points();
    count_ = shell.size();
    const std::string count = has("@spacing@") ? "" : fmt::format("{} points; ", count_);
    const Box box = box_of(shell, &SurfacePoint::position);
    const Vec3 top = top_of(shell, box);
    values_["pressed"] = to_micrometres(side_sign() * (top.z() + 0.5 * diameter_ - kPressedBelow));
    if (has("\"drag\"")) {
      if (!has("@spacing@")) notes_.push_back(fmt::format("{} points", count_));
      if (!options_.path.empty()) return follow_path(top);
      const Vec3 middle = options_.at ? top : top_of_the_middle(shell, box, diameter_);
      return choose_way(shell, {start_above(top), start_above(middle)});
    }
    start_at(start_above(top));
    const Vec3 place = to_world_ * top;
    notes_.push_back(
        options_.side == "z" && !options_.at
            ? fmt::format("{}the tool starts 1 mm above the highest, at x = {:.4g}, y = {:.4g} mm", count,
                          1e3 * top.x(), 1e3 * top.y())
            : fmt::format("{}the tool starts 1 mm off the surface at x = {:.4g}, y = {:.4g}, z = {:.4g} mm", count,
                          1e3 * place.x(), 1e3 * place.y(), 1e3 * place.z()));
  }

  double side_sign() const { return options_.side.front() == '-' ? -1.0 : 1.0; }

  /// The place over which the tool starts: what --at or --path names, else the highest.
  Vec3 top_of(const std::vector<SurfacePoint>& shell, const Box& box) const {
    if (!options_.at && options_.path.empty()) return middle_of_the_top(shell, box.max.z(), 0.1 * diameter_);
    const Vec3 named = to_world_.transpose() * (options_.at ? *options_.at : options_.path.front());
    const auto facing = [&named](const SurfacePoint& point) {
      return point.normal.z() > 0.0 ? (point.position - named).squaredNorm() : std::numeric_limits<double>::infinity();
    };
    return std::ranges::min_element(shell, {}, facing)->position;
  }

  /// The start of a tool whose round tip is to land at `place`.
  Vec3 start_above(const Vec3& place) const {
    return {to_micrometres(place.x()), to_micrometres(place.y()),
            to_micrometres(place.z() + 0.5 * diameter_ + kClearance)};
  }

  void start_at(const Vec3& place) {
    const Vec3 world = to_world_ * place;
    values_["x"] = world.x() + 0.0;  // never -0
    values_["y"] = world.y() + 0.0;
    values_["z"] = world.z() + 0.0;
  }

  /// Leads the tool along the points of --path.
  void follow_path(const Vec3& first) {
    double way = 0.0;
    for (std::size_t i = 1; i < options_.path.size(); ++i) way += (options_.path[i] - options_.path[i - 1]).norm();
    start_at(start_above(first));
    drag_for(way, kDragSpeed * diameter_);
    values_["smoothing"] = 0.5 * diameter_;
    notes_.push_back(fmt::format("dragged over {}", length_text(way)));
  }

  void drag_for(double way, double speed) {
    values_["speed"] = rounded(speed);
    values_["steps"] = static_cast<std::int64_t>(std::ceil(rounded(way / speed) / kStep));
  }

  /// Says how far apart a mesh's points are.
  void note_spacing() {
    if (!has("@spacing@")) return;
    notes_.push_back(fmt::format("{} points, {} apart: a tenth of the tool's diameter",
                                 count_ == 0 ? points().size() : count_,
                                 length_text(values_.at("spacing").get<double>())));
  }

  /// Places the tool above the plane's middle, at a scale that makes it about as long as a tooth.
  void place_mesh_tool() {
    TriangleSoup surface = scenario().files.at(kToolFile).mesh().triangles();  // taken for millimetres
    const double scale = choose_scale(box_of(surface.vertices), "tool");
    values_["tool_scale"] = scale;
    for (Vec3& vertex : surface.vertices) vertex *= scale / 0.001;
    const double touching = find_tip(surface);
    values_["z"] = to_micrometres(touching + kClearance);
    values_["pressed"] = to_micrometres(touching - kPressedBelow);
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
    const Vec3 direction = to_world_ * drag.direction, start = to_world_ * drag.position;
    Json along = Json::array();
    for (const double part : direction) along.push_back(static_cast<int>(part));
    values_["direction"] = along;
    values_["smoothing"] = drag.smoothing;
    drag_for(has_room ? way : 0.25 * longest_, speed);
    if (!has_room) {
      warnings_.push_back(
          fmt::format("no way longer than {} was found over the surface along x or y, from its highest place or its "
                      "middle: set hand.path_m to points on the surface, or initial.position_m and hand.direction",
                      length_text(drag.room)));
      return;
    }
    notes_.push_back(fmt::format(
        "dragged from x = {:.4g}, y = {:.4g}{} mm on along [{}, {}, {}] for {}; the surface ends or turns after {}",
        1e3 * start.x(), 1e3 * start.y(), options_.side == "z" ? "" : fmt::format(", z = {:.4g}", 1e3 * start.z()),
        along[0].dump(), along[1].dump(), along[2].dump(), length_text(way), length_text(drag.room)));
  }

  void choose_stroke_steps() {
    const LoadedScenario loaded = scenario();
    const auto stroke = loaded.files.at(kMotionFile).stroke();
    const auto samples = stroke->motion.samples();
    const auto lower = [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); };
    const double lowest = std::min_element(samples.begin(), samples.end(), lower)->position.z();
    const double last = samples.back().time;
    values_["steps"] = static_cast<std::int64_t>(std::max(1.0, std::ceil(last / kStep) + 1.0));
    notes_.push_back(fmt::format("the stroke lasts from {:.4g} to {:.4g} s; its lowest tip is at z = {:.4g} mm{}",
                                 samples.front().time, last, 1e3 * lowest, options_.on ? "" : ", the plane at 0"));
  }

  std::string description_;
  std::string sections_;
  StartOptions options_;
  fs::path directory_;
  Mat3 to_world_ = Mat3::Identity();  ///< from the side's frame
  bool flip_ = false;                 ///< environment.flip_normals
  std::size_t count_ = 0;             ///< of the scene's points
  double diameter_ = 0.001;           ///< [m]
  double longest_ = 0.0;              ///< edge of the environment's box [m]
  Values values_ = {{"x", 0.0},
                    {"y", 0.0},
                    {"z", 0.0},
                    {"pressed", 0.0},
                    {"scale", 0.001},
                    {"tool_scale", 0.001},
                    {"tip", {0, 0, 0}},
                    {"tip_axis", {0, 0, -1}},
                    {"spacing", nullptr},
                    {"diameter", 0.001},
                    {"length", 0.01},
                    {"direction", {1, 0, 0}},
                    {"path", Json::array()},
                    {"speed", 0.005},
                    {"smoothing", 0.0005}};
  std::vector<std::string> notes_, warnings_;
};

}  // namespace

ScenarioStart scenario_start(const StartKind& kind, const StartOptions& options, const fs::path& directory) {
  return Start(kind, options, directory).result();
}

}  // namespace hapbench
