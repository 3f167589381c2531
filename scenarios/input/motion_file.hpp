#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "results/observe/reference_force.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// The recorded stroke in the contents of a file: CSV with header time_s,px_m,py_m,pz_m and then axis_x,axis_y,axis_z
/// or qw,qx,qy,qz, times strictly increasing, axes not zero, quaternions of norm 1 within 0.001 (both are normalised).
/// A quaternion turns the tool's frame, whose axis points along -z, into the world's. Behind them there may be columns
/// of a measured force. Throws InputError.
RecordedMotion motion_in(std::string_view text, const std::filesystem::path& file);

/// The force on the tool that was measured with the stroke, in the last columns mfx_N,mfy_N,mfz_N; none without them.
/// Precondition: motion_in reads the text.
std::optional<ReferenceForce> recorded_force_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
