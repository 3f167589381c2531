#pragma once

#include <filesystem>

#include "sim/tool/motion.hpp"

namespace hapbench {

/// Reads a recorded stroke: CSV with header time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z, times strictly increasing, axes
/// not zero (they are normalised). Throws InputError.
RecordedMotion read_motion(const std::filesystem::path& file);

}  // namespace hapbench
