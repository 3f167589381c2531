#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "results/observe/force_fidelity.hpp"
#include "sim/contact/contact_source.hpp"
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

/// Reads a trace of contacts from the contents of a CSV file with the header time_s,x_m,y_m,z_m,ux,uy,uz,depth_m, a row
/// for each contact. Times must not fall, depths must not be below 0, and gradients must have length 1 within 0.001;
/// those further off than rounding are normalised, others stay as they are, bit for bit. Throws InputError that names
/// the row, for more than 20 million contacts, and for more than 100 000 of one time.
ContactTrace trace_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
