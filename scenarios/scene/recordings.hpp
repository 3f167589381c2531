#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/observe/force_fidelity.hpp"
#include "sim/contact/trace_source.hpp"
#include "sim/tool/motion.hpp"

/// Recorded data: strokes of a tool, and contacts over time.
namespace hapbench {

/// A recorded stroke: the motion of the tool and, optionally, the force on the tool that was measured during the
/// motion.
struct Stroke {
  RecordedMotion motion;
  std::optional<ReferenceForce> force;
};

/// Parses a stroke from the contents of a CSV file (parse_number_table). Columns in any order:
///   - time_s,px_m,py_m,pz_m: time and position of the tip centre,
///   - axis_x,axis_y,axis_z or qw,qx,qy,qz: axis or orientation of the tool,
///   - optionally mfx_N,mfy_N,mfz_N: measured force.
/// Times must increase strictly. Axes must not be zero, and quaternions must have norm 1 within 0.001. Axes and
/// quaternions are normalised. A quaternion rotates vectors from the tool frame, in which the tool's axis is -z, to the
/// world frame. If `notes` is not null, it receives NumberTable::notes and a note about axes whose length is not 1.
/// Throws InputError that names the line and the sample.
Stroke parse_stroke(std::string_view text, const std::filesystem::path& file,
                    std::vector<std::string>* notes = nullptr);

/// Parses contacts over time from the contents of a CSV file (parse_number_table) with the columns
/// time_s,x_m,y_m,z_m,ux,uy,uz,depth_m. They are time, position, depth gradient (ux,uy,uz) and penetration depth. Times
/// must not decrease, depths must be >= 0, and gradients must have norm 1 within 0.001. Gradients are normalised,
/// unless their norm is 1 within 1e-12. At most 20 million contacts, and 100 000 contacts at one time, are allowed.
/// If `notes` is not null, it receives NumberTable::notes. Throws InputError that names the line and the contact.
ContactTrace parse_contact_trace(std::string_view text, const std::filesystem::path& file,
                                 std::vector<std::string>* notes = nullptr);

}  // namespace hapbench
