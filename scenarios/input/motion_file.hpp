#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "results/observe/force_fidelity.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// A recorded stroke: how the tool moved, and the force on it that was measured meanwhile, if one was.
struct Stroke {
  RecordedMotion motion;
  std::optional<ReferenceForce> force;
};

/// The recorded stroke in the contents of a file: CSV with header time_s,px_m,py_m,pz_m and then axis_x,axis_y,axis_z
/// or qw,qx,qy,qz, times strictly increasing, axes not zero, quaternions of norm 1 within 0.001 (both are normalised).
/// A quaternion turns the tool's frame, whose axis points along -z, into the world's. The last columns may be a
/// measured force, mfx_N,mfy_N,mfz_N. Throws InputError.
Stroke stroke_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
