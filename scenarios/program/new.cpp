#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/fields_text.hpp"
#include "scenarios/program/scenario_start.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// ---- The kinds

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

namespace {

// ---- The command

struct NewOptions {
  std::string kind;
  std::string from;
  std::string on;
  std::string extent;
  std::string side = "z";
  std::vector<std::string> path;
  std::string at;
  bool preview = false;
  std::string out;
  OutputOptions output;
};

const StartKind& kind_named(const std::string& name) {
  require_valid_name("KIND: got", name, names_of(start_kinds(), &StartKind::name));
  return *std::ranges::find(start_kinds(), name, &StartKind::name);
}

void check_source(const StartKind& kind, const std::string& from) {
  if (kind.needs_source && from.empty())
    throw InputError(fmt::format("--from: missing; \"{}\" starts from a file", kind.name));
  if (kind.source == StartSource::none && !from.empty())
    throw InputError(fmt::format("--from: got \"{}\"; \"{}\" starts from no file", from, kind.name));
  std::error_code ignored;
  if (!from.empty() && !fs::exists(from, ignored))
    throw InputError(fmt::format("--from {}: cannot be read: no such file", from));
}

Vec3 place_in(const char* option, const std::string& text) {
  const Words parts = parts_of(text, ',');
  Vec3 place = Vec3::Zero();
  bool is_place = parts.size() == 3;
  for (std::size_t i = 0; is_place && i < parts.size(); ++i) {
    const auto number = finite_number(parts[i]);
    is_place = number.has_value();
    if (number) place[static_cast<Eigen::Index>(i)] = *number;
  }
  if (!is_place) throw InputError(fmt::format("{}: got \"{}\"; allowed: X,Y,Z in metres", option, text));
  return place;
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

/// The command as it was given, without --extent.
std::string command_without_extent(const NewOptions& options) {
  std::vector<std::string> words = {"hapbench", "new", options.kind};
  const auto add = [&words](const char* name, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {name, value});
  };
  add("--from", options.from);
  add("--on", options.on);
  if (options.side != "z") words.push_back("--side=" + options.side);
  for (const std::string& point : options.path) add("--path", point);
  add("--at", options.at);
  if (options.preview) words.emplace_back("--preview");
  add("--out", options.out);
  return shell_line(words);
}

/// The options that say where the scene starts. Throws InputError for those that the kind has no use for.
StartOptions start_options(const NewOptions& options, const StartKind& kind) {
  const std::string name = kind.name;
  const bool drags = name == "drag" || name == "bur", lands = drags || name == "mesh" || name == "shell";
  const bool has_mesh = !options.on.empty() || (kind.source == StartSource::mesh && !options.from.empty());
  const auto require = [](bool is_right, const char* option, const char* allowed) {
    if (!is_right) throw InputError(fmt::format("{}: allowed: {}", option, allowed));
  };
  require(options.on.empty() || name == "stroke", "--on", "for stroke");
  require(options.path.empty() || (drags && options.path.size() > 1 && options.at.empty()), "--path",
          "for drag and bur, two points or more, and without --at");
  require(options.at.empty() || lands, "--at", "for mesh, shell, drag and bur");
  require(options.side == "z" || (lands && !options.from.empty()), "--side",
          "for mesh, shell, drag and bur with --from");
  require(options.extent.empty() || has_mesh, "--extent", "with the file of a mesh");
  if (std::error_code ignored; !options.on.empty() && !fs::exists(options.on, ignored))
    throw InputError(fmt::format("--on {}: cannot be read: no such file", options.on));
  StartOptions start;
  if (!options.from.empty()) start.source = options.from;
  if (!options.on.empty()) start.on = options.on;
  if (!options.extent.empty()) start.extent = length_in("--extent", options.extent);
  start.side = options.side;
  for (const std::string& point : options.path) start.path.push_back(place_in("--path", point));
  if (!options.at.empty()) start.at = place_in("--at", options.at);
  start.command = command_without_extent(options);
  return start;
}

int list_kinds(const OutputOptions& output) {
  Table table({{"KIND", false}, {"what it starts with", false}});
  Json json = Json::array();
  for (const StartKind& kind : start_kinds()) {
    table.add({kind.name, kind.summary});
    json.push_back({{"kind", kind.name}, {"summary", kind.summary}});
  }
  print(output, table.text(), json);
  return kSuccess;
}

/// Runs the new scenario, as `run` does, and draws it.
void draw_preview(const fs::path& scenario, const fs::path& picture, bool quiet) {
  const fs::path run = results_directory("", scenario.stem().string());
  require_writable_directory(run);
  run_scenario(load_scenario(scenario), run, !quiet);
  write_way(run, picture, quiet);
}

int write_new(const NewOptions& options) {
  if (options.kind.empty()) return list_kinds(options.output);
  const StartKind& kind = kind_named(options.kind);
  check_source(kind, options.from);
  const fs::path source = options.from;
  const fs::path out =
      !options.out.empty() ? options.out : (source.empty() ? "" : source.stem().string() + "_") + kind.name + ".json";
  std::error_code ignored;
  const fs::path picture = fs::path(out).replace_extension(".svg");
  if (options.preview && fs::exists(picture, ignored))
    throw InputError(fmt::format("{} exists; choose another name with --out", picture.string()));
  if (fs::exists(out, ignored)) throw InputError(fmt::format("{} exists; choose another with --out", out.string()));
  const fs::path directory = out.parent_path();
  const StartOptions chosen = start_options(options, kind);
  const ScenarioStart start = [&] {
    const WaitNotice notice("trying the scene", !options.output.quiet);
    return scenario_start(kind, chosen, directory);
  }();
  const Json json = parse_json(start.text);
  LoadedScenario loaded = read_scenario(json, directory);
  loaded.file = out;
  print_warnings(loaded, check_named_files(loaded));
  require_writable_directory(directory.empty() ? "." : directory);
  write_file_atomically(out, start.text);

  print_warnings(start.warnings);
  if (options.preview) draw_preview(out, picture, options.output.quiet || options.output.json);
  std::string text = fmt::format("{}: {}\n", out.string(), kind.summary);
  for (const std::string& note : start.notes) text += note + "\n";
  if (options.preview) text += fmt::format("picture of a run in {}\n", picture.string());
  text += "\n";
  Json fields = Json::object();
  for (const auto& [path, meaning] : field_meanings(json)) {
    text += entry(path, meaning, 0, 34);
    fields[path] = meaning;
  }
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
