#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/format/text_lines.hpp"
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
  if (!kind.source.empty() && !kind.is_source_optional && from.empty())
    throw InputError(fmt::format("--from: missing; \"{}\" starts from a file", kind.name));
  if (kind.source.empty() && !from.empty())
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
  const std::string& name = kind.name;
  const bool drags = name == "drag" || name == "bur", lands = drags || name == "mesh" || name == "shell";
  const bool has_mesh = !options.on.empty() || (kind.source == "mesh" && !options.from.empty());
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
  LoadedScenario loaded = read_scenario(start.scene, directory);
  loaded.file = out;
  loaded = checked(std::move(loaded));
  print_warnings(loaded, loaded.file_warnings);
  require_writable_directory(directory.empty() ? "." : directory);
  write_file_atomically(out, json_text(start.scene));

  print_warnings(start.warnings);
  if (options.preview) draw_preview(out, picture, options.output.quiet || options.output.json);
  std::string text = fmt::format("{}: {}\n", out.string(), kind.summary);
  for (const std::string& note : start.notes) text += note + "\n";
  if (options.preview) text += fmt::format("picture of a run in {}\n", picture.string());
  text += "\n";
  Json fields = Json::object();
  for (const auto& [path, meaning] : field_meanings(start.scene)) {
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
