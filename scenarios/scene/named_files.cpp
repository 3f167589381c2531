#include "scenarios/scene/named_files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/point_shell_file.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/parts.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// A text that differs after a change of the file, so that a known file need not be read again. Nothing for a file that
/// is not regular, or that changed so recently that the clock of the file system might not tell the next change.
std::optional<std::string> stamp_of(const std::filesystem::path& file) {
  struct stat s {};
  if (::stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return std::nullopt;
  constexpr std::time_t kSettled = 2;  // [s]
  if (std::time(nullptr) < std::max(s.st_mtim.tv_sec, s.st_ctim.tv_sec) + kSettled) return std::nullopt;
  return fmt::format("stamp {} {} {} {} {} {} {}", s.st_dev, s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec,
                     s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
}

}  // namespace

const NamedFile::Read& NamedFile::read() {
  if (read_) return *read_;
  if (content_.kind == FileContent::Kind::point_shell) shell_extension(path_);
  if (content_.kind == FileContent::Kind::mesh) mesh_extension(path_);
  std::string bytes;
  // Kept under the stamp of before the reading, which a file that changed meanwhile never has again.
  std::optional<std::string> state = stamp_of(path_);
  if (!state) {
    bytes = read_named_file(path_);
    state = hash_text(hash_of(bytes));
  }
  const std::string key = fmt::format("file {} as {}, scale {}, spacing {}, flip {}: {}", *state,
                                      static_cast<int>(content_.kind), content_.sampling.scale,
                                      content_.sampling.spacing.value_or(0.0), content_.sampling.flip, path_.string());
  const auto parse = [&] {
    if (bytes.empty()) bytes = read_named_file(path_);
    return std::make_shared<const Read>(Read{hash_text(hash_of(bytes)), parsed(bytes)});
  };
  // A parsed mesh takes some times the space of its text.
  read_ = shared_cache().get<Read>(key, parse, [&bytes](const Read&) { return 4 * bytes.size(); });
  return *read_;
}

NamedFile::Contents NamedFile::parsed(std::string_view bytes) const {
  switch (content_.kind) {
    case FileContent::Kind::point_shell:
      return point_shell_in(bytes, path_);
    case FileContent::Kind::mesh:
      return MeshFile(bytes, path_, content_.sampling);
    case FileContent::Kind::stroke:
      return stroke_in(bytes, path_);
    case FileContent::Kind::trace:
      return trace_in(bytes, path_);
    case FileContent::Kind::library:
      break;
  }
  return {};
}

std::vector<Warning> NamedFile::warnings() {
  std::vector<Warning> warnings;
  if (content_.kind != FileContent::Kind::mesh) return warnings;
  for (const std::string& text : mesh().warnings(path_)) warnings.push_back({"mesh_file", pointer_, text});
  return warnings;
}

NamedFiles::NamedFiles(Scenario scenario) {
  const auto add = [&](const std::string& pointer, const std::string& path, const FileContent& content) {
    files_.push_back(std::make_shared<NamedFile>(pointer, scenario.directory / path, content));
  };
  json_of([&scenario](Fields& f) { f.object(scenario); }, add);
}

NamedFile* NamedFiles::find(std::string_view pointer) const {
  const auto found = std::ranges::find(files_, pointer, &NamedFile::pointer);
  return found == files_.end() ? nullptr : found->get();
}

// ---- Recordings

namespace {

constexpr std::size_t kMostSamples = 10'000'000;
constexpr double kLargestNormError = 1e-3;  ///< of a quaternion: three decimals suffice
constexpr std::size_t kForceColumns = 3;
constexpr std::size_t kAxisPose = 7;  ///< columns of time, position and axis; a quaternion has one more

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t row, const std::string& problem) {
  fail_at(fmt::format("{}, sample {}", file.string(), row + 1), problem);
}

Vec3 axis_of(std::span<const double> cells, const std::filesystem::path& file, std::size_t row) {
  const Vec3 axis(cells[0], cells[1], cells[2]);
  const double length = axis.norm();
  if (length > 1e-12 && length < 1e12) return axis / length;
  fail(file, row, fmt::format("got an axis of length {}; allowed: 1e-12 ... 1e12", length));
}

Eigen::Quaterniond orientation_of(std::span<const double> cells, const std::filesystem::path& file, std::size_t row) {
  const Eigen::Quaterniond q(cells[0], cells[1], cells[2], cells[3]);
  const double norm = q.norm();
  if (std::abs(norm - 1.0) <= kLargestNormError) return q.normalized();
  fail(file, row,
       fmt::format("got a quaternion qw,qx,qy,qz of norm {}; allowed: 1 within {}", norm, kLargestNormError));
}

constexpr std::size_t kMostContacts = 20'000'000, kMostAtOnce = 100'000;
constexpr double kLargestLengthError = 1e-3;  ///< of a gradient: three decimals suffice
constexpr double kRounding = 1e-12;           ///< of the length of a gradient in double precision
constexpr std::string_view kTraceHeader = "time_s,x_m,y_m,z_m,ux,uy,uz,depth_m";

}  // namespace

Stroke stroke_in(std::string_view text, const std::filesystem::path& file) {
  const NumberTable table =
      number_table_in(text, file,
                      {"time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z", "time_s,px_m,py_m,pz_m,qw,qx,qy,qz",
                       "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z,mfx_N,mfy_N,mfz_N",
                       "time_s,px_m,py_m,pz_m,qw,qx,qy,qz,mfx_N,mfy_N,mfz_N"},
                      kMostSamples);
  if (table.rows() == 0) fail(file, 0, "no samples; allowed: at least one");
  const bool has_force = table.columns >= kAxisPose + kForceColumns;
  const std::size_t pose = table.columns - (has_force ? kForceColumns : 0);
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

ContactTrace trace_in(std::string_view text, const std::filesystem::path& file) {
  const NumberTable table = number_table_in(text, file, {kTraceHeader}, kMostContacts);
  ContactTrace trace;
  trace.contacts.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    const auto refuse = [&](const std::string& problem) {
      fail_at(fmt::format("{}, contact {}", file.string(), i + 1), problem);
    };
    if (trace.times.empty() || trace.times.back().time < row[0])
      trace.times.push_back({row[0], i});
    else if (row[0] < trace.times.back().time)
      refuse(fmt::format("got time {} after {}; allowed: ascending times", row[0], trace.times.back().time));
    if (i - trace.times.back().first >= kMostAtOnce)
      refuse(fmt::format("got more contacts at time {}; allowed: at most {}", row[0], kMostAtOnce));
    ContactTrace::Contact contact{{row[1], row[2], row[3]}, {row[4], row[5], row[6]}, row[7]};
    const double length = contact.gradient.norm();
    if (!(std::abs(length - 1.0) <= kLargestLengthError))
      refuse(fmt::format("got a gradient ux,uy,uz of length {}; allowed: 1 within {}", length, kLargestLengthError));
    if (std::abs(length - 1.0) > kRounding) contact.gradient /= length;
    if (contact.depth < 0.0)
      refuse(fmt::format("got depth {}; allowed: >= 0, how deep the point is in the tool", contact.depth));
    trace.contacts.push_back(contact);
  }
  return trace;
}

}  // namespace hapbench
