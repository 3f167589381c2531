#include "scenarios/scene/recordings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMaxSamples = 10'000'000;  ///< maximum number of samples of a stroke
/// Allowed deviation of a quaternion's norm from 1. Three decimals in the file suffice.
constexpr double kMaxNormError = 1e-3;
constexpr std::size_t kForceColumns = 3;  ///< columns of a measured force
constexpr std::size_t kAxisPose = 7;      ///< columns of time, position and axis; with a quaternion there are 8 columns

/// Throws InputError about a sample. `row` counts from 0, the sample in the message from 1.
[[noreturn]] void fail(const std::filesystem::path& file, std::size_t row, const std::string& problem) {
  fail_in({.file = file, .entry = fmt::format("sample {}", row + 1)}, problem);
}

/// Returns the normalised axis. Throws InputError if it is too short or too long.
Vec3 axis_of(std::span<const double> cells, const std::filesystem::path& file, std::size_t row) {
  const Vec3 axis(cells[0], cells[1], cells[2]);
  const double length = axis.norm();
  if (length > 1e-12 && length < 1e12) return axis / length;
  fail(file, row, fmt::format("got an axis of length {}; allowed: 1e-12 ... 1e12", length));
}

/// Returns the normalised quaternion. Throws InputError if its norm is not 1.
Eigen::Quaterniond orientation_of(std::span<const double> cells, const std::filesystem::path& file, std::size_t row) {
  const Eigen::Quaterniond q(cells[0], cells[1], cells[2], cells[3]);
  const double norm = q.norm();
  if (std::abs(norm - 1.0) <= kMaxNormError) return q.normalized();
  fail(file, row, fmt::format("got a quaternion qw,qx,qy,qz of norm {}; allowed: 1 within {}", norm, kMaxNormError));
}

constexpr std::size_t kMaxContacts = 20'000'000;      ///< maximum number of contacts of a recording
constexpr std::size_t kMaxContactsPerTime = 100'000;  ///< maximum number of contacts with the same time
/// Allowed deviation of a gradient's norm from 1. Three decimals in the file suffice.
constexpr double kMaxLengthError = 1e-3;
constexpr double kRounding = 1e-12;  ///< deviation of a unit gradient's norm from 1 by rounding
constexpr std::string_view kTraceHeader = "time_s,x_m,y_m,z_m,ux,uy,uz,depth_m";

}  // namespace

Stroke parse_stroke(std::string_view text, const std::filesystem::path& file) {
  // Parse the table. Its header shows whether the pose has an axis or a quaternion, and whether there is a force.
  const NumberTable table =
      parse_number_table(text, file,
                         {"time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z", "time_s,px_m,py_m,pz_m,qw,qx,qy,qz",
                          "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z,mfx_N,mfy_N,mfz_N",
                          "time_s,px_m,py_m,pz_m,qw,qx,qy,qz,mfx_N,mfy_N,mfz_N"},
                         kMaxSamples);
  if (table.rows() == 0) fail(file, 0, "no samples; allowed: at least one");
  const bool has_force = table.columns >= kAxisPose + kForceColumns;
  const std::size_t pose = table.columns - (has_force ? kForceColumns : 0);
  // Convert each row to a pose and a force.
  std::vector<RecordedMotion::Sample> samples;
  samples.reserve(table.rows());
  std::vector<ReferenceForce::Sample> forces;
  if (has_force) forces.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    RecordedMotion::Sample sample{row[0], {row[1], row[2], row[3]}};
    if (pose == kAxisPose)
      sample.axis = axis_of(row.subspan(4), file, i);
    else
      sample.orientation = orientation_of(row.subspan(4), file, i);
    if (i > 0 && !(samples.back().time < row[0])) {
      fail(file, i,
           fmt::format("got time {} after {}; allowed: strictly increasing times", row[0], samples.back().time));
    }
    samples.push_back(sample);
    if (has_force) forces.push_back({row[0], {row[pose], row[pose + 1], row[pose + 2]}});
  }
  Stroke stroke{RecordedMotion(std::move(samples)), {}};
  if (has_force) stroke.force.emplace(std::move(forces));
  return stroke;
}

ContactTrace parse_contact_trace(std::string_view text, const std::filesystem::path& file) {
  const NumberTable table = parse_number_table(text, file, {kTraceHeader}, kMaxContacts);
  ContactTrace trace;
  trace.contacts.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    const auto refuse = [&](const std::string& problem) {
      fail_in({.file = file, .entry = fmt::format("contact {}", i + 1)}, problem);
    };
    // Start a new time, or add the contact to the current time.
    if (trace.times.empty() || trace.times.back().time < row[0])
      trace.times.push_back({row[0], i});
    else if (row[0] < trace.times.back().time)
      refuse(fmt::format("got time {} after {}; allowed: ascending times", row[0], trace.times.back().time));
    if (i - trace.times.back().first >= kMaxContactsPerTime)
      refuse(fmt::format("got more contacts at time {}; allowed: at most {}", row[0], kMaxContactsPerTime));
    // Check the contact and normalise its gradient.
    ContactTrace::Contact contact{{row[1], row[2], row[3]}, {row[4], row[5], row[6]}, row[7]};
    const double length = contact.gradient.norm();
    if (!(std::abs(length - 1.0) <= kMaxLengthError))
      refuse(fmt::format("got a gradient ux,uy,uz of length {}; allowed: 1 within {}", length, kMaxLengthError));
    if (std::abs(length - 1.0) > kRounding) contact.gradient /= length;
    if (contact.depth < 0.0)
      refuse(fmt::format("got depth {}; allowed: >= 0, how deep the point is in the tool", contact.depth));
    trace.contacts.push_back(contact);
  }
  return trace;
}

}  // namespace hapbench
