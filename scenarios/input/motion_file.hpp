#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "results/observe/force_fidelity.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// A recorded stroke: the motion of the tool and, optionally, the force on it that was measured at the same time.
struct Stroke {
  RecordedMotion motion;
  std::optional<ReferenceForce> force;
};

/// Reads a recorded stroke from the contents of a CSV file. Its header is time_s,px_m,py_m,pz_m, then
/// axis_x,axis_y,axis_z or qw,qx,qy,qz, then optionally a measured force mfx_N,mfy_N,mfz_N. Times must increase
/// strictly, axes must not be zero, and quaternions must have norm 1 within 0.001; both are normalised. A quaternion
/// turns the tool's frame, whose axis points along -z, into the world's. Throws InputError.
Stroke stroke_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
