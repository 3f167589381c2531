#include "scenarios/input/motion_file.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostSamples = 10'000'000;

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t row, const std::string& problem) {
  throw InputError(InputError::Kind::relation, fmt::format("{}, sample {}", file.string(), row + 1), problem);
}

constexpr std::string_view kForceColumns = ",mfx_N,mfy_N,mfz_N";
constexpr std::size_t kQuaternionPose = 8;  ///< columns of time, position and orientation
constexpr std::string_view kHeaders[] = {"time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z",
                                         "time_s,px_m,py_m,pz_m,qw,qx,qy,qz",
                                         "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z,mfx_N,mfy_N,mfz_N",
                                         "time_s,px_m,py_m,pz_m,qw,qx,qy,qz,mfx_N,mfy_N,mfz_N"};

/// The first line, without blanks around it.
std::string_view header_of(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::string_view line = text.substr(0, text.find('\n'));
  const std::size_t first = std::min(line.find_first_not_of(kBlank), line.size());
  return line.substr(first, line.find_last_not_of(kBlank) + 1 - first);
}

bool has_force(std::string_view text) {
  return header_of(text).ends_with(kForceColumns);
}

Vec3 axis_of(const Vec3& given, const std::filesystem::path& file, std::size_t row) {
  const double length = given.norm();
  if (length > 1e-12 && length < 1e12) return given / length;
  fail(file, row, fmt::format("got an axis of length {}; allowed: 1e-12 ... 1e12", length));
}

/// Of the tool that the quaternion turns into the world.
Vec3 axis_of(const Eigen::Quaterniond& turn, const std::filesystem::path& file, std::size_t row) {
  const double norm = turn.norm();
  if (std::abs(norm - 1.0) <= 1e-3) return turn.normalized() * Vec3(0.0, 0.0, -1.0);
  fail(file, row, fmt::format("got a quaternion qw,qx,qy,qz of norm {}; allowed: 1 within 0.001", norm));
}

}  // namespace

std::optional<ReferenceForce> recorded_force_in(std::string_view text, const std::filesystem::path& file) {
  if (!has_force(text)) return std::nullopt;
  const NumberTable table = number_table_in(text, file, std::string(header_of(text)), kMostSamples);
  std::vector<ReferenceForce::Sample> samples;
  samples.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i), force = row.last(3);
    samples.push_back({row[0], {force[0], force[1], force[2]}});
  }
  return ReferenceForce(std::move(samples));
}

RecordedMotion motion_in(std::string_view text, const std::filesystem::path& file) {
  const auto known = std::find(std::begin(kHeaders), std::end(kHeaders), header_of(text));
  const NumberTable table =
      number_table_in(text, file, std::string(known == std::end(kHeaders) ? kHeaders[0] : *known), kMostSamples);
  if (table.rows() == 0) fail(file, 0, "no samples; allowed: at least one");
  const std::size_t pose = table.columns - (has_force(text) ? 3 : 0);
  std::vector<RecordedMotion::Sample> samples;
  samples.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i).first(pose);
    const Vec3 axis = pose == kQuaternionPose ? axis_of(Eigen::Quaterniond(row[4], row[5], row[6], row[7]), file, i)
                                              : axis_of(Vec3(row[4], row[5], row[6]), file, i);
    if (i > 0 && !(samples.back().time < row[0])) {
      fail(file, i,
           fmt::format("got time {} after {}; allowed: strictly increasing times", row[0], samples.back().time));
    }
    samples.push_back({row[0], {row[1], row[2], row[3]}, axis});
  }
  return RecordedMotion(std::move(samples));
}

}  // namespace hapbench
