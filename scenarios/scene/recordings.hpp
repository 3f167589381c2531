#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "results/observe/force_fidelity.hpp"
#include "sim/contact/trace_source.hpp"
#include "sim/tool/motion.hpp"

/// Files that were recorded: strokes of a tool, and contacts over time.
namespace hapbench {

/// A recorded stroke: the motion of the tool and, optionally, the force on it that was measured at the same time.
struct Stroke {
  RecordedMotion motion;
  std::optional<ReferenceForce> force;
};

/// The stroke in the contents of a CSV file with the header time_s,px_m,py_m,pz_m, then axis_x,axis_y,axis_z or
/// qw,qx,qy,qz, then perhaps a measured force mfx_N,mfy_N,mfz_N. Times must increase strictly, axes must not be zero,
/// and quaternions must have norm 1 within 0.001; both are normalised. A quaternion turns the tool's frame, whose axis
/// points along -z, into the world's. Throws InputError that names the sample.
Stroke stroke_in(std::string_view text, const std::filesystem::path& file);

/// The contacts in a CSV file with the header time_s,x_m,y_m,z_m,ux,uy,uz,depth_m: at most 20 million, 100 000 of one
/// time. Times must not fall, depths must not be below 0, and gradients, normalised unless unit to rounding, must be
/// unit to 0.001. Throws InputError that names the contact.
ContactTrace trace_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
