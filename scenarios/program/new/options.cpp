#include "scenarios/program/new/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/shell_words.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

Vec3 parse_position(const char* option, const std::string& text) {
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(text, ','))
    if (const auto number = finite_number(part)) numbers.push_back(*number);
  if (numbers.size() != 3 || std::ranges::count(text, ',') != 2)
    fail_in_option(option, fmt::format("got \"{}\"; allowed: X,Y,Z in metres", text));
  return Vec3(numbers.data());
}

double parse_length(const char* option, const std::string& text) {
  for (const auto& [unit, metres] : kLengthUnits) {
    if (!text.ends_with(unit)) continue;
    const auto number = finite_number(std::string_view(text).substr(0, text.size() - unit.size()));
    if (number && *number > 0.0) return *number * metres;
  }
  fail_in_option(option,
                 fmt::format("got \"{}\"; allowed: a length above 0 with its unit, mm, cm, m or in: 12mm", text));
}

std::string PlacementOptions::text() const {
  std::vector<std::string> names;
  if (at) names.emplace_back("--at");
  if (side) names.emplace_back("--side");
  if (path) names.emplace_back("--path with two or more points on the surface");
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  return text;
}

PlacementOptions placement_options(const NewOptions& options, const StartKind& kind) {
  // `drags`: the tool moves along the surface, after it starts above the surface.
  const bool drags = kind.name == "drag" || kind.name == "bur", follows_path = kind.name == "fidelity";
  const bool lands = drags || kind.name == "mesh" || kind.name == "shell";
  return {lands, drags || follows_path, (lands || follows_path) && !options.from.empty()};
}

std::string command_with(const NewOptions& options, const std::string& added) {
  std::string line = "hapbench new " + options.kind;
  const auto add = [&line](const char* option, const std::string& value, const std::string& word) {
    if (!value.empty()) line += fmt::format(" {} {}", option, word);
  };
  add("--from", options.from, shell_file(options.from));
  add("--on", options.on, shell_file(options.on));
  add("--extent", options.extent, shell_word(options.extent));
  add("--unit", options.unit, options.unit);
  if (options.side != "z") line += " --side=" + options.side;
  for (const std::string& point : options.path) add("--path", point, shell_word(point));
  add("--depth", options.depth, shell_word(options.depth));
  add("--at", options.at, shell_word(options.at));
  if (options.preview) line += " --preview";
  add("--out", options.out, shell_file(options.out));
  if (options.output.quiet) line += " --quiet";
  if (options.output.json) line += " --json";
  return line + " " + added;
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one line for each rule of the options.
void check_options(const NewOptions& options, const StartKind& kind) {
  const std::string &name = kind.name, &from = options.from;
  const PlacementOptions accepted = placement_options(options, kind);
  const bool has_mesh = !options.on.empty() || (kind.source == "mesh" && !from.empty());
  const auto require = [](bool is_right, const char* option, const char* allowed) {
    if (!is_right) fail_in_option(option, fmt::format("allowed: {}", allowed));
  };
  const auto require_file = [](const char* option, const std::string& file) {
    std::error_code error;
    if (!file.empty() && !std::filesystem::exists(file, error)) {
      const std::string problem = error ? error.message() : "no such file";
      fail_in({.about_options = {option}}, fmt::format("{} {}: cannot be read: {}", option, file, problem));
    }
  };
  if (!kind.source.empty() && !kind.is_source_optional && from.empty())
    fail_in_option("--from", fmt::format("missing; \"{}\" starts from a file", name));
  if (kind.source.empty() && !from.empty())
    fail_in_option("--from", fmt::format(R"(got "{}"; "{}" starts from no file)", from, name));
  require_file("--from", from);
  if (kind.source == "stroke" && is_mesh_name(from))
    fail_in_option("--from", fmt::format("got {}, a mesh; allowed: a recorded stroke; --on {} plays it over the mesh",
                                         from, shell_file(from)));
  require(options.on.empty() || name == "stroke", "--on", "for stroke");
  require(options.path.empty() || (accepted.path && options.path.size() > 1 && options.at.empty()), "--path",
          "for drag, bur and fidelity, two points or more, and without --at");
  require(options.depth.empty() || name == "fidelity", "--depth", "for fidelity");
  require(options.at.empty() || accepted.at, "--at", "for mesh, shell, drag and bur");
  require(options.side == "z" || accepted.side, "--side", "for mesh, shell, drag, bur and fidelity with --from");
  require(options.extent.empty() || has_mesh, "--extent", "with the file of a mesh");
  require(options.unit.empty() || has_mesh || name == "shell", "--unit", "with the file of a mesh or shell");
  require(options.unit.empty() || options.extent.empty(), "--unit", "either --unit or --extent");
  require(name != "shell" || options.unit.empty() || options.unit == "m", "--unit",
          "m for a shell, whose file is in metres; convert the coordinates of the file first");
  require_file("--on", options.on);
}

}  // namespace hapbench
