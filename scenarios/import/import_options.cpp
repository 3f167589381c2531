#include "scenarios/import/import_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

struct FormatName {
  const char* name;
  StrokeFormat format;
};
constexpr FormatName kFormats[] = {{"csv", StrokeFormat::csv},
                                   {"traj", StrokeFormat::traj},
                                   {"hapi", StrokeFormat::hapi},
                                   {"hapi-binary", StrokeFormat::hapi_binary}};

constexpr const char* kAxisColumns[] = {"axis_x", "axis_y", "axis_z"};
constexpr const char* kWxyzColumns[] = {"qw", "qx", "qy", "qz"};
constexpr const char* kXyzwColumns[] = {"qx", "qy", "qz", "qw"};
constexpr const char* kAxisAngleColumns[] = {"axis_x", "axis_y", "axis_z", "angle"};
constexpr const char* kMatrixColumns[] = {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"};

struct OrientationName {
  const char* name;
  OrientationKind kind;
  std::span<const char* const> columns;
};
const OrientationName kOrientations[] = {{"none", OrientationKind::none, {}},
                                         {"axis", OrientationKind::axis, kAxisColumns},
                                         {"quat_wxyz", OrientationKind::quat_wxyz, kWxyzColumns},
                                         {"quat_xyzw", OrientationKind::quat_xyzw, kXyzwColumns},
                                         {"axis_angle", OrientationKind::axis_angle, kAxisAngleColumns},
                                         {"matrix", OrientationKind::matrix, kMatrixColumns}};

template <class Rows>
std::vector<std::string> names_in(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

template <class Rows>
const auto& named(const Rows& rows, const char* option, const std::string& name) {
  require_valid_name(fmt::format("{}: got", option), name, names_in(rows));
  return *std::find_if(std::begin(rows), std::end(rows), [&name](const auto& row) { return row.name == name; });
}

std::vector<std::string> quantities() {
  std::vector<std::string> names = {"time", "position", "px", "py", "pz", "orientation", "force", "mfx", "mfy", "mfz"};
  for (const OrientationName& orientation : kOrientations) {
    for (const char* column : orientation.columns) {
      if (std::find(names.begin(), names.end(), column) == names.end()) names.emplace_back(column);
    }
  }
  return names;
}

}  // namespace

std::span<const char* const> orientation_columns(OrientationKind kind) {
  return kOrientations[static_cast<std::size_t>(kind)].columns;
}

std::vector<std::string> stroke_format_names() {
  return names_in(kFormats);
}

std::vector<std::string> orientation_names() {
  return names_in(kOrientations);
}

void set_format(ImportOptions& options, const std::string& name) {
  options.format = named(kFormats, "format", name).format;
}

void set_orientation(ImportOptions& options, const std::string& name) {
  options.orientation = named(kOrientations, "orientation", name).kind;
}

void set_column(ImportOptions& options, const std::string& quantity, std::vector<std::string> columns) {
  require_valid_name("columns: got", quantity, quantities());
  std::erase(options.optional_columns, quantity);
  options.columns[quantity] = std::move(columns);
}

void set_scale(ImportOptions& options, const std::string& quantity, double factor) {
  const std::vector<std::string> valid = {"time", "position", "angle", "force"};
  require_valid_name("scale: got", quantity, valid);
  if (!(factor > 0.0 && std::isfinite(factor)))
    throw InputError(fmt::format("scale: {}: got {}; allowed: > 0", quantity, factor));
  options.scale[quantity] = factor;
}

void set_frame(ImportOptions& options, const std::vector<std::string>& words) {
  const auto fail = [] {
    throw InputError(
        "frame: allowed: three of x, y, z, each once, with or without \"-\", as in \"x,-z,y\", that make a "
        "right-handed frame");
  };
  if (words.size() != 3) fail();
  Mat3 frame = Mat3::Zero();
  for (int i = 0; i < 3; ++i) {
    const std::string& word = words[static_cast<std::size_t>(i)];
    const bool negative = word.starts_with("-");
    const std::string letter = word.substr(negative ? 1 : 0);
    if (letter != "x" && letter != "y" && letter != "z") fail();
    frame(i, letter[0] - 'x') = negative ? -1.0 : 1.0;
  }
  // A mirror image turns right hands into left ones, and no tool can follow.
  if (std::abs(frame.determinant() - 1.0) > 0.5) fail();
  options.frame = frame;
}

}  // namespace hapbench
