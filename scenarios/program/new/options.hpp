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
  std::string kind, from, on, extent, unit, side = "z", at, out;
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

/// The point of a word such as "0.01,0,0" [m]. Throws InputError that names the option.
Vec3 place_in(const char* option, const std::string& text);
/// The length of a word such as "12mm" [m]. Throws InputError that names the option.
double length_in(const char* option, const std::string& text);
/// Throws InputError for options that the kind lacks or has no use for, and for files that are not there.
void check_options(const NewOptions& options, const StartKind& kind);

}  // namespace hapbench
