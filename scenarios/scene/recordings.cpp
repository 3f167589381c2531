#include "scenarios/scene/recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
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
/// Allowed deviation of a quaternion's norm from 1. Quaternions that the file gives with three decimals are accepted.
constexpr double kMaxNormError = 1e-3;
/// Quantities of a stroke: time, position, axis or orientation, measured force.
const std::vector<TableQuantity> kStrokeColumns = {
    {.alternatives = {{"time_s"}}},
    {.alternatives = {{"px_m", "py_m", "pz_m"}}},
    {.alternatives = {{"axis_x", "axis_y", "axis_z"}, {"qw", "qx", "qy", "qz"}}},
    {.alternatives = {{"mfx_N", "mfy_N", "mfz_N"}}, .is_optional = true}};
constexpr std::size_t kPoseQuantity = 2, kForceQuantity = 3;  ///< indices in kStrokeColumns
constexpr std::size_t kForceColumns = 3;                      ///< columns of a measured force

/// Collects faults in the rows of a table, except numbers that cannot be parsed. Row numbers start at 0; the numbers of
/// samples and contacts in a message start at 1.
class EntryFaults {
 public:
  /// `what` is the noun for a row in messages, such as "sample". The arguments must outlive the object.
  EntryFaults(const std::filesystem::path& file, const NumberTable& table, const char* what)
      : file_(file), table_(table), what_(what) {}

  void add(std::size_t row, const std::string& problem) {
    faults_.add(table_.line_of(row), problem, fmt::format("{} {}", what_, row + 1));
  }
  bool any() const { return faults_.any(); }
  /// Throws InputError if there is a fault. The message describes the first fault and gives the number of further rows
  /// with faults.
  void throw_if_any() const { faults_.throw_if_any(file_); }

 private:
  const std::filesystem::path& file_;
  const NumberTable& table_;
  const char* what_;
  RowFaults faults_;
};

/// Returns a text that describes the fault of an axis that is too short or too long to be normalised. Empty if the axis
/// is valid.
std::string axis_problem(const Vec3& axis) {
  const double length = axis.norm();
  if (length > 1e-12 && length < 1e12) return "";
  return fmt::format("got an axis of length {}; allowed: 1e-12 ... 1e12", length);
}

/// Returns a text that describes the fault of a quaternion whose norm is not 1. Empty if the quaternion is valid.
std::string quaternion_problem(const Eigen::Quaterniond& q) {
  const double norm = q.norm();
  if (std::abs(norm - 1.0) <= kMaxNormError) return "";
  return fmt::format("got a quaternion qw,qx,qy,qz of norm {}; allowed: 1 within {}", norm, kMaxNormError);
}

/// Statistics of the tool axes in one file, over the axes whose length is not 1.
struct OtherLengths {
  std::size_t count = 0, first_line = 0;
  double smallest = 0.0, largest = 0.0;

  void add(double length, std::size_t line) {
    if (std::abs(length - 1.0) <= kMaxNormError) return;
    if (count++ == 0) {
      first_line = line;
      smallest = largest = length;
    }
    smallest = std::min(smallest, length);
    largest = std::max(largest, length);
  }
  /// Adds a note if the file has axes whose length is not 1.
  void note(std::vector<std::string>& notes) const {
    if (count == 0) return;
    notes.push_back(
        fmt::format("line {}: axes were divided by their lengths, which are not 1: {}, of length {:.4g} ... "
                    "{:.4g}; are they directions?",
                    first_line, count, smallest, largest));
  }
};

constexpr std::size_t kMaxContacts = 20'000'000;      ///< maximum number of contacts of a recording
constexpr std::size_t kMaxContactsPerTime = 100'000;  ///< maximum number of contacts with the same time
/// Allowed deviation of a gradient's norm from 1. Gradients that the file gives with three decimals are accepted.
constexpr double kMaxLengthError = 1e-3;
constexpr double kRounding = 1e-12;  ///< gradients whose norm deviates from 1 by at most this value are not normalised
/// Quantities of a trace: time, position, gradient, depth.
const std::vector<TableQuantity> kTraceColumns = {{.alternatives = {{"time_s"}}},
                                                  {.alternatives = {{"x_m", "y_m", "z_m"}}},
                                                  {.alternatives = {{"ux", "uy", "uz"}}},
                                                  {.alternatives = {{"depth_m"}}}};

}  // namespace

Stroke parse_stroke(std::string_view text, const std::filesystem::path& file, std::vector<std::string>* notes) {
  // Parse the table. The header shows whether the pose has an axis or a quaternion, and whether there is a force.
  const NumberTable table = parse_number_table(text, file, kStrokeColumns, kMaxSamples);
  if (notes != nullptr) *notes = table.notes;
  EntryFaults faults(file, table, "sample");
  if (table.rows() == 0) fail_in_file(file, "has a header and no samples; allowed: at least one row");
  const bool has_axis = table.chosen[kPoseQuantity] == 0, has_force = table.chosen[kForceQuantity].has_value();
  const std::size_t pose = table.columns - (has_force ? kForceColumns : 0);
  // Convert each row to a pose and a force.
  std::vector<RecordedMotion::Sample> samples;
  samples.reserve(table.rows());
  std::vector<ReferenceForce::Sample> forces;
  if (has_force) forces.reserve(table.rows());
  OtherLengths other_lengths;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    RecordedMotion::Sample sample{row[0], {row[1], row[2], row[3]}};
    std::string problem;
    if (has_axis) {
      const Vec3 axis(row[4], row[5], row[6]);
      problem = axis_problem(axis);
      if (problem.empty()) other_lengths.add(axis.norm(), table.line_of(i));
      sample.axis = axis.normalized();
    } else {
      const Eigen::Quaterniond turn(row[4], row[5], row[6], row[7]);
      problem = quaternion_problem(turn);
      sample.orientation = turn.normalized();
    }
    if (problem.empty() && !samples.empty() && !(samples.back().time < row[0]))
      problem = fmt::format("got time {} after {}; allowed: strictly increasing times", row[0], samples.back().time);
    if (!problem.empty()) {
      faults.add(i, problem);
      continue;
    }
    samples.push_back(sample);
    if (has_force) forces.push_back({row[0], {row[pose], row[pose + 1], row[pose + 2]}});
  }
  faults.throw_if_any();
  if (notes != nullptr) other_lengths.note(*notes);
  Stroke stroke{RecordedMotion(std::move(samples)), {}};
  if (has_force) stroke.force.emplace(std::move(forces));
  return stroke;
}

ContactTrace parse_contact_trace(std::string_view text, const std::filesystem::path& file,
                                 std::vector<std::string>* notes) {
  const NumberTable table = parse_number_table(text, file, kTraceColumns, kMaxContacts);
  if (notes != nullptr) *notes = table.notes;
  EntryFaults faults(file, table, "contact");
  ContactTrace trace;
  trace.contacts.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    const auto refuse = [&](const std::string& problem) { faults.add(i, problem); };
    // If the time is later than the time of the previous row, start a new group of contacts with the same time.
    if (trace.times.empty() || trace.times.back().time < row[0])
      trace.times.push_back({row[0], i});
    else if (row[0] < trace.times.back().time)
      refuse(fmt::format("got time {} after {}; allowed: ascending times", row[0], trace.times.back().time));
    else if (i - trace.times.back().first >= kMaxContactsPerTime)
      refuse(fmt::format("got too many contacts at time {}; allowed: at most {}", row[0], kMaxContactsPerTime));
    // Check the contact and normalise its gradient.
    ContactTrace::Contact contact{{row[1], row[2], row[3]}, {row[4], row[5], row[6]}, row[7]};
    const double length = contact.gradient.norm();
    if (!(std::abs(length - 1.0) <= kMaxLengthError))
      refuse(fmt::format("got a gradient ux,uy,uz of length {}; allowed: 1 within {}", length, kMaxLengthError));
    if (std::abs(length - 1.0) > kRounding) contact.gradient /= length;
    if (contact.depth < 0.0)
      refuse(fmt::format("got depth {}; allowed: >= 0, the depth of the point inside the tool", contact.depth));
    trace.contacts.push_back(contact);
  }
  faults.throw_if_any();
  return trace;
}

}  // namespace hapbench
