#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/program/new/kinds.hpp"
#include "scenarios/program/options.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The options of `new`.
struct NewOptions {
  std::string kind, from, on, extent, unit, side = "z", at, depth, out;
  std::vector<std::string> path;
  bool preview = false;
  OutputOptions output;
};

/// Unit of length that an option accepts.
struct LengthUnit {
  std::string_view name;
  double metres;
};
inline constexpr LengthUnit kLengthUnits[] = {{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"in", 0.0254}};

/// Converts the value of an option, such as "0.01,0,0", to a point [m]. Throws InputError with the option's name if the
/// value is not a point.
Vec3 parse_position(const char* option, const std::string& text);
/// Converts the value of an option, such as "12mm", to a length [m]. Throws InputError with the option's name if the
/// value is not a length.
double parse_length(const char* option, const std::string& text);
/// Options that choose the start or the path, and that `new` accepts.
struct PlacementOptions {
  bool at, path, side;

  /// Returns the options as text, such as "--at or --side"; empty if there are none.
  std::string text() const;
};
/// Returns the options that `new` accepts for a kind of scene. --side requires a file (--from).
PlacementOptions placement_options(const NewOptions& options, const StartKind& kind);
/// Returns the command line of `hapbench new` with these options and the option `added`, quoted for a shell.
std::string command_with(const NewOptions& options, const std::string& added);
/// Throws InputError if the kind requires an option that is missing, if an option does not apply to the kind,
/// or if a file does not exist.
void check_options(const NewOptions& options, const StartKind& kind);

}  // namespace hapbench
