#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "device_model/hands/drag_hand.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/bundled_files.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/scene/parts.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// The command `new`: each scene runs at once and touches something, and has only what a newcomer changes first.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr double kStep = 0.0005;  ///< of the scenes [s]

struct StartKind {
  std::string name, summary;
  std::string source;  ///< what it is made from: "mesh", "shell" or "stroke"; empty for nothing
  bool is_source_optional;
  Json scene;  ///< with what does not depend on the source
};

/// Those of scenarios/library/starts.json, in the order in which they are shown. Throws InputError without that file.
const std::vector<StartKind>& start_kinds() {
  static const std::vector<StartKind> kinds = [] {
    const Json json = parse_json(read_named_file(installed_folder("scenarios/library") / "starts.json"));
    std::vector<StartKind> all;
    for (const Json& kind : json.at("kinds")) {
      Json scene = {{"description", kind.at("summary")},
                    {"time", {{"step_s", kStep}, {"steps", kind.value("steps", 2000)}}}};
      for (const Json& part : kind.at("parts")) scene.update(json.at("parts").at(part.get<std::string>()));
      const auto text = [&](const char* key) { return kind.at(key).get<std::string>(); };
      all.push_back({text("kind"), text("summary"), kind.value("from", ""), kind.value("optional", false), scene});
    }
    return all;
  }();
  return kinds;
}

const StartKind& kind_named(const std::string& name) {
  require_valid_name("KIND: got", name, names_of(start_kinds(), &StartKind::name), "hapbench new");
  return *std::ranges::find(start_kinds(), name, &StartKind::name);
}

// ---- The options

struct NewOptions {
  std::string kind, from, on, extent, side = "z", at, out;
  std::vector<std::string> path;
  bool preview = false;
  OutputOptions output;
};

Vec3 place_in(const char* option, const std::string& text) {
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(text, ','))
    if (const auto number = finite_number(part)) numbers.push_back(*number);
  if (numbers.size() != 3 || std::ranges::count(text, ',') != 2)
    throw InputError(fmt::format("{}: got \"{}\"; allowed: X,Y,Z in metres", option, text));
  return Vec3(numbers.data());
}

double length_in(const char* option, const std::string& text) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"in", 0.0254}};
  for (const auto& [unit, metres] : kUnits) {
    if (!text.ends_with(unit)) continue;
    const auto number = finite_number(std::string_view(text).substr(0, text.size() - unit.size()));
    if (number && *number > 0.0) return *number * metres;
  }
  throw InputError(
      fmt::format("{}: got \"{}\"; allowed: a length above 0 with its unit, mm, cm, m or in: 12mm", option, text));
}

/// Throws InputError for options that the kind lacks or has no use for, and for files that are not there.
void check_options(const NewOptions& options, const StartKind& kind) {
  const std::string &name = kind.name, &from = options.from;
  const bool drags = name == "drag" || name == "bur", lands = drags || name == "mesh" || name == "shell";
  const bool has_mesh = !options.on.empty() || (kind.source == "mesh" && !from.empty());
  const auto require = [](bool is_right, const char* option, const char* allowed) {
    if (!is_right) throw InputError(fmt::format("{}: allowed: {}", option, allowed));
  };
  const auto require_file = [](const char* option, const std::string& file) {
    std::error_code ignored;
    if (!file.empty() && !fs::exists(file, ignored))
      throw InputError(fmt::format("{} {}: cannot be read: no such file", option, file));
  };
  if (!kind.source.empty() && !kind.is_source_optional && from.empty())
    throw InputError(fmt::format("--from: missing; \"{}\" starts from a file", name));
  if (kind.source.empty() && !from.empty())
    throw InputError(fmt::format("--from: got \"{}\"; \"{}\" starts from no file", from, name));
  require_file("--from", from);
  require(options.on.empty() || name == "stroke", "--on", "for stroke");
  require(options.path.empty() || (drags && options.path.size() > 1 && options.at.empty()), "--path",
          "for drag and bur, two points or more, and without --at");
  require(options.at.empty() || lands, "--at", "for mesh, shell, drag and bur");
  require(options.side == "z" || (lands && !from.empty()), "--side", "for mesh, shell, drag and bur with --from");
  require(options.extent.empty() || has_mesh, "--extent", "with the file of a mesh");
  require_file("--on", options.on);
}

// ---- Where a tool that comes along -z starts over a surface

/// The point nearest to the middle of those within `tolerance` of the top.
Vec3 middle_of_the_top(const std::vector<SurfacePoint>& points, double top, double tolerance) {
  std::vector<Vec3> high;
  for (const SurfacePoint& point : points)
    if (point.position.z() >= top - tolerance) high.push_back(point.position);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& place : high) middle += place;
  middle /= static_cast<double>(high.size());
  return *std::ranges::min_element(high, {}, [&middle](const Vec3& place) { return (place - middle).norm(); });
}

/// The highest of the points within `aside` of the box's middle line; where there are none, as in a ring, the middle.
Vec3 top_of_the_middle(const std::vector<SurfacePoint>& points, const Box& box, double aside) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  Vec3 top(middle.x(), middle.y(), box.min.z());
  for (const SurfacePoint& point : points)
    if ((point.position - middle).head<2>().norm() <= aside && point.position.z() > top.z()) top = point.position;
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
/// a way is at least `enough` long; else takes the longest. A later one has to lead a tenth further, so that rounding
/// does not decide. A walk of some 10 ms for each combination. Preconditions: a point in the shell, a position.
DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough) {
  constexpr double kFurther = 1.1;
  const double furthest = diagonal(shell.bounds());
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

constexpr double kClearance = 0.001;      ///< between tool and surface at the start [m]
constexpr double kDragSpeed = 5.0;        ///< in diameters of the tool [1/s]
constexpr double kPressedBelow = 0.0035;  ///< the hand's target, 1 N below the surface with the spring of a press [m]

/// Rounds to two significant digits, as people write lengths.
double rounded(double value) {
  return std::stod(fmt::format("{:.2g}", value));
}

Json list_of(const Vec3& v) {
  return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0};  // never -0
}

/// Rounds to the micrometre, as people write places.
double to_micrometres(double metres) {
  return std::round(1e6 * metres) / 1e6;
}

/// Makes a start for a file in `directory`: its values are determined one after the other. Places are found in the
/// frame of the side from which the tool comes, in which that is z. Throws InputError when a file cannot be used.
class Start {
 public:
  Start(const StartKind& kind, const NewOptions& options, const fs::path& directory)
      : scene(kind.scene), options_(options), directory_(directory) {
    if (!options.extent.empty()) extent_ = length_in("--extent", options.extent);
    for (const std::string& point : options.path) named_.push_back(place_in("--path", point));
    if (!options.at.empty()) named_.push_back(place_in("--at", options.at));
    const bool is_on_mesh =
        !options.on.empty() || (kind.source == "mesh" && kind.is_source_optional && !options.from.empty());
    if (is_on_mesh) scene["environment"] = kind_named("mesh").scene.at("environment");
    turn_to_side();
    name_files();
    const bool is_placed = scene.contains("initial") && scene["initial"]["position_m"].is_null();
    if (is_placed) scene["initial"]["position_m"] = {0, 0, 0};
    if (has_type("environment", "mesh")) scale_environment();
    if (has_type("tool", "mesh")) {
      place_mesh_tool();
    } else if (is_placed) {
      place_tool();
    }
    if (kind.source == "stroke") choose_stroke_steps();
    if (!has_type("environment", "mesh")) return;
    notes.push_back(fmt::format("{} points, {} apart: a tenth of the tool's diameter", shell()->size(),
                                length_text(scene["environment"]["spacing_m"].get<double>())));
  }

  Json scene;                      ///< content of the scenario file
  std::vector<std::string> notes;  ///< sizes and choices, a line each
  std::vector<std::string> warnings;

 private:
  bool has_type(const char* part, const char* type) const {
    return scene.contains(part) && scene.at(part).value(kTypeField, "") == type;
  }

  /// Writes the names of the source and of the mesh below a stroke where they are used.
  void name_files() {
    for (const auto& [field, file] : {std::pair{"/environment/file", mesh_file()},
                                      {"/tool/file", options_.from},
                                      {"/motion/position/file", options_.from}}) {
      const Json::json_pointer place(field);
      if (scene.contains(place))
        scene[place] = fs::proximate(file, directory_.empty() ? "." : directory_).generic_string();
    }
  }

  /// Puts the side's axes in the place of x, y and z.
  void turn_to_side() {
    const auto axis = static_cast<Eigen::Index>(options_.side.back() - 'x');
    const Vec3 up = side_sign() * Vec3::Unit(axis), lean = Vec3::Unit(axis == 0 ? 1 : 0);
    to_world_ << lean, up.cross(lean), up;
    if (options_.side != "z" && has_type("hand", "impedance"))
      scene["motion"] = {{"orientation", {{"up", list_of(up)}, {"lean", list_of(lean)}}}};
  }

  /// The file of the environment, or of a tool.
  const std::string& mesh_file() const { return options_.on.empty() ? options_.from : options_.on; }

  LoadedScenario scenario() const { return read_scenario(scene, directory_); }

  std::shared_ptr<const PointShell> shell() const {
    const LoadedScenario loaded = scenario();
    return make_shell(loaded.scenario, loaded.files);
  }

  /// The points of the scene in the side's frame.
  std::vector<SurfacePoint> points() const {
    std::vector<SurfacePoint> points = shell()->points();
    for (SurfacePoint& point : points)
      point = {to_world_.transpose() * point.position, to_world_.transpose() * point.normal};
    return points;
  }

  /// The scale that gives an object, which was first read as millimetres, its stated size. A file of which none is
  /// stated is in metres. Throws InputError when it then is not 1 mm to 1 m long, with its length in either unit.
  double choose_scale(const Box& box, const char* object) {
    const double longest = box.size().maxCoeff() / 0.001;
    if (!extent_ && (longest < kShortestObject || longest > kLongestObject)) {
      const std::string command = fmt::format("hapbench new {} {} {} --extent", options_.kind,
                                              options_.on.empty() ? "--from" : "--on", mesh_file());
      throw InputError(fmt::format(
          "{}: the {} is {} long in metres, {} in millimetres; allowed: {} ... {}, or to state its size: \"{} {:.7g}mm\" or "
          "\"{} {:.7g}m\"",
          mesh_file(), object, length_text(longest), length_text(0.001 * longest), length_text(kShortestObject),
          length_text(kLongestObject), command, longest, command, longest));
    }
    const double scale = extent_ ? std::stod(fmt::format("{:.6g}", *extent_ / longest)) : 1.0;
    notes.push_back(
        fmt::format("longest edge of the {}'s box: {}, with scale {}", object, length_text(longest * scale), scale));
    return scale;
  }

  /// The tool is sized by the mesh, but for one that a stroke leads.
  void scale_environment() {
    const Box box = bounds_of(points());
    const double scale = choose_scale(box, "mesh");
    scene["environment"]["scale"] = scale;
    if (options_.on.empty()) choose_tool(box.size().maxCoeff() / 0.001 * scale);
    scene["environment"]["spacing_m"] = rounded(diameter_ / 10.0);
    if (!options_.on.empty())
      notes.push_back(fmt::format("the mesh: {}", place_text(Box{box.min / 0.001 * scale, box.max / 0.001 * scale})));
  }

  /// The tool is 1 mm thick, or a fiftieth of a longer object.
  void choose_tool(double longest) {
    diameter_ = std::max(0.001, rounded(longest / 50.0));
    for (const auto& [field, size] : {std::pair{"diameter_m", diameter_}, {"length_m", 10.0 * diameter_}})
      if (scene.contains("tool") && scene["tool"].contains(field)) scene["tool"][field] = size;
  }

  /// Turns the normals of an open mesh round that point away from the side, about its highest place.
  std::vector<SurfacePoint> facing_points() {
    std::vector<SurfacePoint> shell = points();
    const Box box = bounds_of(shell);
    choose_tool(box.size().maxCoeff());
    const Vec3 top = middle_of_the_top(shell, box.max.z(), 0.1 * diameter_);
    const bool is_open =
        !has_type("environment", "mesh") || !scenario().files.at(kEnvironmentFile).mesh().open_edges().empty();
    double facing = 0.0;
    for (const SurfacePoint& point : shell) {
      const Vec3 from_top = point.position - top;
      // Not those of the far side of a thin wall.
      if (from_top.norm() <= 0.5 * diameter_ && from_top.z() >= -0.1 * diameter_) facing += point.normal.z();
    }
    if (facing >= 0.0 || !is_open) return shell;
    const std::string side = options_.side.front() == '-' ? options_.side.substr(1) : "-" + options_.side;
    const std::string found = fmt::format("its normals point away from side {}", options_.side);
    if (!has_type("environment", "mesh")) {
      throw InputError(fmt::format("--from {}: {}; allowed: normals turned round, or --side={}",
                                   fs::path(options_.from).generic_string(), found, side));
    }
    scene["environment"]["flip_normals"] = true;
    notes.push_back(fmt::format(
        "{} and are turned round, environment.flip_normals; or press from the other side: --side={}", found, side));
    return points();
  }

  void place_tool() {
    const std::vector<SurfacePoint> shell = facing_points();
    const std::string count = has_type("environment", "mesh") ? "" : fmt::format("{} points", shell.size());
    const Box box = bounds_of(shell);
    const Vec3 top = top_of(shell, box);
    pressed_ = to_micrometres(side_sign() * (top.z() + 0.5 * diameter_ - kPressedBelow));
    if (has_type("hand", "drag")) {
      if (!count.empty()) notes.push_back(count);
      if (named_.size() > 1) return follow_path(top);
      const Vec3 middle = named_.empty() ? top_of_the_middle(shell, box, diameter_) : top;
      return choose_way(PointShell(shell, 0.0), {start_above(top), start_above(middle)});
    }
    start_at(start_above(top));
    const bool is_on_top = options_.side == "z" && named_.empty();
    notes.push_back(fmt::format("{}{}the tool starts 1 mm {} {}", count, count.empty() ? "" : "; ",
                                is_on_top ? "above the highest, at" : "off the surface at", said(top, !is_on_top)));
  }

  /// A place in millimetres, with its height where that does not go without saying.
  std::string said(const Vec3& place, bool with_height) const {
    const Vec3 world = to_world_ * place;
    return fmt::format("x = {:.4g}, y = {:.4g}{} mm", 1e3 * world.x(), 1e3 * world.y(),
                       with_height ? fmt::format(", z = {:.4g}", 1e3 * world.z()) : "");
  }

  double side_sign() const { return options_.side.front() == '-' ? -1.0 : 1.0; }

  /// The place over which the tool starts: the named one, else the highest.
  Vec3 top_of(const std::vector<SurfacePoint>& shell, const Box& box) const {
    if (named_.empty()) return middle_of_the_top(shell, box.max.z(), 0.1 * diameter_);
    const Vec3 named = to_world_.transpose() * named_.front();
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
    const Json world = list_of(to_world_ * place);
    scene["initial"]["position_m"] = world;
    if (!has_type("hand", "impedance")) return;
    Json& target = scene["hand"]["target"];
    target = {{"x_m", world[0]}, {"y_m", world[1]}, {"z_m", world[2]}};
    Json& along = target[std::string(1, options_.side.back()) + "_m"];
    along = {{kTypeField, "waypoints"},
             {"points", Json::array({Json::array({0, along}), Json::array({0.5, pressed_})})},
             {"interpolation", "cosine"}};
  }

  void follow_path(const Vec3& first) {
    double way = 0.0;
    Json& hand = scene["hand"];
    hand.erase("direction");
    for (const Vec3& point : named_) hand["path_m"].push_back(list_of(point));
    for (std::size_t i = 1; i < named_.size(); ++i) way += (named_[i] - named_[i - 1]).norm();
    start_at(start_above(first));
    drag_for(way);
    hand["smoothing_m"] = 0.5 * diameter_;
    notes.push_back(fmt::format("dragged over {}", length_text(way)));
  }

  void drag_for(double way) {
    const double speed = kDragSpeed * diameter_;
    scene["hand"]["speed_m_per_s"] = rounded(speed);
    scene["time"]["steps"] = static_cast<std::int64_t>(std::ceil(rounded(way / speed) / kStep));
  }

  /// Places the tool above the plane's middle. Its tip is where the format has it without more words.
  void place_mesh_tool() {
    const TriangleSoup surface = scenario().files.at(kToolFile).mesh().triangles();  // taken for millimetres
    Box box = box_of(surface.vertices);
    const double scale = choose_scale(box, "tool");
    scene["tool"]["scale"] = scale;
    box = {scale / 0.001 * box.min, scale / 0.001 * box.max};
    notes.emplace_back(
        "taken for its tip centre: the file's origin, the tip pointing along -z; tool.tip_m and tool.tip_axis say "
        "otherwise");
    if (const std::string odd = odd_frame(box); !odd.empty())
      warnings.push_back(fmt::format("the tool {}: set tool.tip_m and tool.tip_axis", odd));
    pressed_ = to_micrometres(-box.min.z() - kPressedBelow);
    start_at({0.0, 0.0, to_micrometres(-box.min.z() + kClearance)});
  }

  /// Drags over four fifths of the way to where the surface ends.
  void choose_way(const PointShell& shell, const std::vector<Vec3>& starts) {
    const double enough = 0.25 * shell.bounds().size().maxCoeff();
    const DragStart drag = choose_drag(shell, starts, 0.5 * diameter_, enough);
    const double way = 0.8 * drag.room;
    const bool has_room = way >= diameter_;
    start_at(drag.position);
    const Vec3 direction = to_world_ * drag.direction;
    Json along = Json::array();
    for (const double part : direction) along.push_back(static_cast<int>(part));
    scene["hand"]["direction"] = along;
    scene["hand"]["smoothing_m"] = drag.smoothing;
    drag_for(has_room ? way : enough);
    if (!has_room) {
      warnings.push_back(
          fmt::format("no way longer than {} was found over the surface along x or y, from its highest place or its "
                      "middle: set hand.path_m to points on the surface, or initial.position_m and hand.direction",
                      length_text(drag.room)));
      return;
    }
    notes.push_back(fmt::format("dragged from {} on along [{}, {}, {}] for {}; the surface ends or turns after {}",
                                said(drag.position, options_.side != "z"), along[0].dump(), along[1].dump(),
                                along[2].dump(), length_text(way), length_text(drag.room)));
  }

  void choose_stroke_steps() {
    const LoadedScenario loaded = scenario();
    const auto stroke = loaded.files.at(kMotionFile).stroke();
    const auto samples = stroke->motion.samples();
    const auto height = [](const auto& sample) { return sample.position.z(); };
    const double lowest = height(*std::ranges::min_element(samples, {}, height)), last = samples.back().time;
    scene["time"]["steps"] = static_cast<std::int64_t>(std::max(1.0, std::ceil(last / kStep) + 1.0));
    notes.push_back(fmt::format("the stroke lasts from {:.4g} to {:.4g} s; its lowest tip is at z = {:.4g} mm{}",
                                samples.front().time, last, 1e3 * lowest,
                                options_.on.empty() ? ", the plane at 0" : ""));
  }

  const NewOptions& options_;
  fs::path directory_;
  std::optional<double> extent_;      ///< of the mesh: longest edge of its box [m]
  std::vector<Vec3> named_;           ///< the tool starts over the surface's place nearest to it; then a drag's way [m]
  Mat3 to_world_ = Mat3::Identity();  ///< from the side's frame
  double diameter_ = 0.001;           ///< [m]
  double pressed_ = 0.0;              ///< where a hand that presses leads the tool, along the side's axis [m]
};

// ---- The command

/// The object of the value's type; null when the value is not an object with fields.
const ValueGuide* object_of(const Json& value, const ValueGuide& guide) {
  if (!value.is_object()) return nullptr;
  if (guide.choices.empty()) return &guide;
  for (const ValueGuide& choice : guide.choices)
    if (value.value(kTypeField, choice.may_be_untyped ? choice.type : "") == choice.type) return &choice;
  return nullptr;
}

/// Adds the meaning of each field that a value has, by its path, objects before their fields.
void add_meanings(Json& meanings, const std::string& prefix, const Json& value, const ValueGuide& object) {
  for (const auto& entry : value.items()) {
    const auto field = std::ranges::find(object.fields, entry.key(), &FieldGuide::name);
    if (field == object.fields.end()) continue;  // the type
    meanings[prefix + entry.key()] = field->meaning;
    if (const ValueGuide* nested = object_of(entry.value(), field->value))
      add_meanings(meanings, prefix + entry.key() + ".", entry.value(), *nested);
  }
}

int list_kinds(const OutputOptions& output) {
  const Columns<StartKind> columns = {{"kind", "", "", &StartKind::name, under("KIND")},
                                      {"summary", "", "", &StartKind::summary, under("what it starts with")}};
  print(output, columns.table(start_kinds()).text(), columns.json_list(start_kinds()));
  return kSuccess;
}

void draw_preview(const fs::path& scenario, const fs::path& picture, bool quiet) {
  const fs::path run = results_directory("", scenario.stem().string());
  require_writable_directory(run);
  run_scenario(load_scenario(scenario), run, !quiet);
  write_way(run, picture, quiet);
}

int write_new(const NewOptions& options) {
  if (options.kind.empty()) return list_kinds(options.output);
  const StartKind& kind = kind_named(options.kind);
  check_options(options, kind);
  const fs::path source = options.from;
  const fs::path out =
      !options.out.empty() ? options.out : (source.empty() ? "" : source.stem().string() + "_") + kind.name + ".json";
  std::error_code ignored;
  const fs::path picture = fs::path(out).replace_extension(".svg");
  if (options.preview && fs::exists(picture, ignored))
    throw InputError(fmt::format("{} exists; choose another name with --out", picture.string()));
  if (fs::exists(out, ignored)) throw InputError(fmt::format("{} exists; choose another with --out", out.string()));
  const fs::path directory = out.parent_path();
  const Start start = [&] {
    const WaitNotice notice("trying the scene", !options.output.quiet);
    return Start(kind, options, directory);
  }();
  LoadedScenario loaded = read_scenario(start.scene, directory);
  loaded.file = out;
  loaded = checked(std::move(loaded));
  print_warnings(with_files(loaded, loaded.file_warnings));
  require_writable_directory(directory.empty() ? "." : directory);
  write_file_atomically(out, json_text(start.scene));

  print_warnings(start.warnings);
  if (options.preview) draw_preview(out, picture, options.output.quiet || options.output.json);
  std::string text = fmt::format("{}: {}\n", out.string(), kind.summary);
  for (const std::string& note : start.notes) text += note + "\n";
  if (options.preview) text += fmt::format("picture of a run in {}\n", picture.string());
  text += "\n";
  Json fields = Json::object();
  add_meanings(fields, "", start.scene, scenario_guide());
  for (const auto& [path, meaning] : fields.items()) text += entry(path, meaning.get<std::string>(), 0, 34);
  text += fmt::format("\n\"hapbench describe scenario\" shows all fields; next: hapbench run {}\n", out.string());
  Json said = {{"file", out.string()}, {"notes", start.notes}, {"fields", fields}};
  if (options.preview) said["picture"] = picture.string();
  print(options.output, text, said);
  return kSuccess;
}

}  // namespace

void add_new(CommandLine& line) {
  auto [command, options] = line.command("new", "Write a scenario to start from and explain its fields", write_new);
  command.add("kind", options.kind, "the kind of scenario; without it, the kinds are listed");
  command.add("--from", options.from, "the file of the mesh, shell or stroke to start from");
  command.add("--on", options.on, "of a stroke: the mesh that it is played back over, in place of a plane");
  command.add(
      "--extent", options.extent,
      "size of the mesh, the longest edge of its box, with a unit: 12mm, 1.2cm, 0.012m, 0.5in (default: the file is "
      "in metres)");
  command.add("--side", options.side, "from which the tool comes: x, y, z (default), or --side=-x, -y, -z",
              {.one_of = {"x", "y", "z", "-x", "-y", "-z"}});
  command.add("--path", options.path, "X,Y,Z [m] of a point to drag over; give it for each, two or more",
              {.several = true});
  command.add("--at", options.at, "X,Y,Z [m]: start over the place of the surface that is nearest to it");
  command.flag("--preview", options.preview, "run the scene and draw it: the surface, the tool on its way; FILE.svg");
  command.add("--out", options.out, "the file to write, which must not exist (default: [FROM_]KIND.json)");
}

}  // namespace hapbench
