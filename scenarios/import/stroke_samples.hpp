#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "scenarios/import/import_options.hpp"

namespace hapbench {

/// A recorded stroke in SI units and the scenario's frame. All lists are as long as `time`, but `force`, which is empty
/// without a measured force.
struct StrokeSamples {
  std::vector<double> time;              ///< [s], strictly increasing
  std::vector<Vec3> position;            ///< of the tip [m]
  std::vector<Eigen::Quaterniond> turn;  ///< unit; the tool's frame, whose axis is -z, into the world's
  std::vector<Vec3> force;               ///< on the tool by what it touches [N]
  bool has_roll = true;                  ///< false when an axis alone is known; `turn` then has any roll

  std::size_t size() const { return time.size(); }
};

/// A recording as it was read.
struct ReadStroke {
  StrokeSamples samples;
  std::vector<std::size_t> rows;      ///< of each sample in the file
  const char* row_word = "line";      ///< what they count
  std::size_t rows_read = 0;          ///< with those that were left out
  std::vector<std::string> left_out;  ///< bad rows, at most kMostFaults; none unless they may be left out
  std::size_t left_out_count = 0;
  double unit_deviation = 0.0;     ///< largest |norm - 1| of a quaternion or an axis, before it was normalised
  std::vector<std::string> notes;  ///< what a reader of the stroke must know
  /// Coordinates before they were turned and shifted [m], for their quantum.
  std::array<std::vector<double>, 3> coordinates;
};

/// Quaternions, axes and matrices whose norm is further from 1 are not rounded but wrong.
inline constexpr double kMostUnitDeviation = 1e-3;

/// Reads a recording. Bad rows (too few values, no finite number, time that does not increase, an orientation that is
/// none, a jump faster than `most_speed`) are refused all together, each with its row, or left out when the options
/// say so. Throws InputError.
ReadStroke read_stroke(std::string_view bytes, const std::filesystem::path& file, const ImportOptions& options);

}  // namespace hapbench
