#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/import/import_options.hpp"
#include "scenarios/import/resample_stroke.hpp"
#include "scenarios/import/smooth_stroke.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// What was found in a recording and done with it.
struct ImportReport {
  std::size_t rows_read = 0, rows_left_out = 0;
  std::size_t samples = 0;  ///< of the stroke
  StrokeClock clock;        ///< as recorded
  bool resampled = false;
  double rate = 0.0;                             ///< of the stroke [Hz]
  std::vector<StrokeGap> gaps;                   ///< bridged
  Box box;                                       ///< around the tip's places [m]
  double speed_p99 = 0.0, speed_max = 0.0;       ///< between samples of the stroke [m/s]
  std::array<std::optional<double>, 3> quantum;  ///< of the recorded coordinates [m]
  double unit_deviation = 0.0;                   ///< largest of an orientation, before it was normalised
  bool has_roll = false;                         ///< the stroke has quaternions; else axes
  std::optional<double> force_min, force_max;    ///< norm of the measured force [N]; none without one
  std::optional<SmoothingChange> smoothing;
  std::vector<std::string> warnings;  ///< a sentence each

  /// The coarsest coordinate's [m]; none when all were kept in full.
  std::optional<double> coarsest() const;
};

struct ImportedStroke {
  StrokeSamples samples;
  ImportReport report;
};

/// A recording made into a stroke that a scenario plays back: read, brought to an even clock that starts at 0, and
/// smoothed. Throws InputError.
ImportedStroke import_stroke(std::string_view bytes, const std::filesystem::path& file, const ImportOptions& options);

/// The stroke's file: time_s,px_m,py_m,pz_m, then qw,qx,qy,qz or axis_x,axis_y,axis_z, then with a measured force
/// mfx_N,mfy_N,mfz_N.
std::string stroke_text(const StrokeSamples& stroke);

}  // namespace hapbench
