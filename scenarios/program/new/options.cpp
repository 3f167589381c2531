#include "scenarios/program/new/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "scenarios/input/input_error.hpp"
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

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one line for each rule of the options.
void check_options(const NewOptions& options, const StartKind& kind) {
  const std::string &name = kind.name, &from = options.from;
  // `lands`: the tool starts above a surface. `drags`: it also moves along the surface.
  const bool drags = name == "drag" || name == "bur", lands = drags || name == "mesh" || name == "shell";
  const bool follows_path = name == "fidelity";
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
  require(options.on.empty() || name == "stroke", "--on", "for stroke");
  require(options.path.empty() || ((drags || follows_path) && options.path.size() > 1 && options.at.empty()), "--path",
          "for drag, bur and fidelity, two points or more, and without --at");
  require(options.depth.empty() || follows_path, "--depth", "for fidelity");
  require(options.at.empty() || lands, "--at", "for mesh, shell, drag and bur");
  require(options.side == "z" || ((lands || follows_path) && !from.empty()), "--side",
          "for mesh, shell, drag, bur and fidelity with --from");
  require(options.extent.empty() || has_mesh, "--extent", "with the file of a mesh");
  require(options.unit.empty() || has_mesh || name == "shell", "--unit", "with the file of a mesh or shell");
  require(options.unit.empty() || options.extent.empty(), "--unit", "either --unit or --extent");
  require(name != "shell" || options.unit.empty() || options.unit == "m", "--unit",
          "m for a shell, whose file is in metres; convert the coordinates of the file first");
  require_file("--on", options.on);
}

}  // namespace hapbench
