#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/import/sample_source.hpp"
#include "scenarios/input/json_file.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// What a recording says of the tool's orientation, and in which order.
enum class OrientationKind {
  none,        ///< nothing: the recorded frame is never turned
  axis,        ///< x y z: the direction out of the tip itself, of any length; the roll stays unknown
  quat_wxyz,   ///< unit quaternion that turns the recorded tool's frame into the world's
  quat_xyzw,   ///< the same with its real part last
  axis_angle,  ///< unit axis x y z and angle [rad]
  matrix       ///< rotation matrix, row by row
};

/// Names of the orientation's columns, in the order of the kind.
std::span<const char* const> orientation_columns(OrientationKind kind);

/// Least squares by a polynomial of this order over so many neighbours (Savitzky and Golay 1964).
struct Smoothing {
  int window = 0;  ///< samples, odd
  int order = 0;   ///< less than the window
};

/// What a recording's numbers mean. Defaults: metres, seconds, newtons, radians; the tip points along -z.
struct ImportOptions {
  StrokeFormat format = StrokeFormat::csv;
  bool floats = false;  ///< hapi_binary: numbers of four bytes
  /// Where quantities are: by "time", "position", "orientation" and "force" the first column of consecutive ones, by
  /// "px", "qw", "mfx" … single ones. A column is named or numbered from 1; of several names the first that the file
  /// has counts.
  std::map<std::string, std::vector<std::string>> columns;
  /// Those of `columns` that the file need not have: what a preset says of orientation and force.
  std::vector<std::string> optional_columns;
  std::optional<double> sample_rate;    ///< [Hz], of a file without a column of times
  std::map<std::string, double> scale;  ///< "time", "position", "angle", "force": what one of the file's units is
  OrientationKind orientation = OrientationKind::none;
  Vec3 tip_axis = {0.0, 0.0, -1.0};  ///< direction out of the tip in the recorded tool's frame, any length
  Mat3 frame = Mat3::Identity();     ///< turns the recorded world into the scenario's; a rotation
  Vec3 shift = Vec3::Zero();         ///< added to turned positions [m]
  bool force_by_tool = false;        ///< forces are those of the tool on the object, so they are turned round
  std::optional<double> rate;        ///< of the stroke [Hz]; else as recorded, or the median's if irregular
  std::optional<Smoothing> smoothing;
  double most_speed = 5.0;     ///< faster samples are no motion of a hand [m/s]
  double longest_gap = 0.5;    ///< more is not bridged [s]
  bool skip_bad_rows = false;  ///< leave bad rows out instead of refusing the file
};

/// The names of the options that have names: valid words of --format and --orientation.
std::vector<std::string> stroke_format_names();
std::vector<std::string> orientation_names();

/// Sets options from texts as the command line and presets have them. Throw InputError that names the option.
void set_format(ImportOptions& options, const std::string& name);
void set_orientation(ImportOptions& options, const std::string& name);
void set_column(ImportOptions& options, const std::string& quantity, std::vector<std::string> columns);
void set_scale(ImportOptions& options, const std::string& quantity, double factor);
/// Three words, as in x,-z,y: which recorded direction is the scenario's x, y and z.
void set_frame(ImportOptions& options, const std::vector<std::string>& words);

/// A preset is a JSON file with the options as fields; users copy and correct it.
struct ImportPreset {
  std::string name;
  std::string description;
  std::filesystem::path file;
};
/// Those that come with the program, by name. Throws InputError.
std::vector<ImportPreset> import_presets();
/// Sets the options that the preset of that name, or in that file, gives. Throws InputError.
void apply_preset(ImportOptions& options, const std::string& name_or_file);

}  // namespace hapbench
