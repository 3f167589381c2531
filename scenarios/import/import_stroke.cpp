#include "scenarios/import/import_stroke.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/io/json_text.hpp"
#include "scenarios/import/quantum.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Times from the first sample on.
void start_clock_at_zero(StrokeSamples& stroke) {
  const double first = stroke.time.front();
  for (double& time : stroke.time) time -= first;
}

void refuse_long_gaps(const ReadStroke& read, const std::vector<StrokeGap>& gaps, const fs::path& file,
                      double longest) {
  std::vector<InputError> faults;
  for (const StrokeGap& gap : gaps) {
    if (gap.duration <= longest || faults.size() == kMostFaults) continue;
    faults.emplace_back(InputError::Kind::relation,
                        fmt::format("{}, {} {}", file.string(), read.row_word, read.rows[gap.before]),
                        fmt::format("a gap of {:.4g} s follows; allowed: {:g} s (--max-gap)", gap.duration, longest));
  }
  if (!faults.empty()) throw InputError::all(faults);
}

Box box_around(const std::vector<Vec3>& points) {
  Box box{points.front(), points.front()};
  for (const Vec3& point : points) {
    box.min = box.min.cwiseMin(point);
    box.max = box.max.cwiseMax(point);
  }
  return box;
}

void add_speeds(const StrokeSamples& stroke, ImportReport& report) {
  std::vector<double> speeds;
  for (std::size_t i = 1; i < stroke.size(); ++i)
    speeds.push_back((stroke.position[i] - stroke.position[i - 1]).norm() / (stroke.time[i] - stroke.time[i - 1]));
  std::sort(speeds.begin(), speeds.end());
  if (speeds.empty()) return;
  report.speed_max = speeds.back();
  report.speed_p99 = speeds[static_cast<std::size_t>(0.99 * static_cast<double>(speeds.size() - 1))];
}

/// As recorded; of an irregular clock that of its median interval, as a whole number.
double usual_rate(const StrokeClock& clock, std::size_t samples) {
  if (clock.is_regular) return static_cast<double>(samples - 1) / clock.duration;
  const double rate = 1.0 / clock.interval_median;
  return rate < 10.0 ? rate : std::round(rate);
}

void add_force_range(const StrokeSamples& stroke, ImportReport& report) {
  for (const Vec3& force : stroke.force) {
    const double norm = force.norm();
    report.force_min = std::min(report.force_min.value_or(norm), norm);
    report.force_max = std::max(report.force_max.value_or(norm), norm);
  }
}

void add_warnings(const ReadStroke& read, ImportReport& report) {
  report.warnings = read.notes;
  if (read.left_out_count > 0) report.warnings.push_back(fmt::format("{} bad rows were left out", read.left_out_count));
  report.warnings.insert(report.warnings.end(), read.left_out.begin(), read.left_out.end());
  constexpr std::size_t kMostGaps = 5;
  for (std::size_t i = 0; i < std::min(kMostGaps, report.gaps.size()); ++i)
    report.warnings.push_back(fmt::format("a gap of {:.4g} s behind {} {} is bridged by a straight line",
                                          report.gaps[i].duration, read.row_word, read.rows[report.gaps[i].before]));
  if (report.gaps.size() > kMostGaps) report.warnings.push_back(fmt::format("{} gaps in all", report.gaps.size()));
  // A hand's stroke is millimetres to decimetres long.
  const double longest = (report.box.max - report.box.min).maxCoeff();
  if (longest > 3.0 || longest < 1e-5)
    report.warnings.push_back(
        fmt::format("the tip's places are within {:.4g} m, which is no stroke of a hand: is the "
                    "scale right? (--scale position=0.001 is for millimetres)",
                    longest));
}

}  // namespace

std::optional<double> ImportReport::coarsest() const {
  std::optional<double> found;
  for (const auto& one : quantum) {
    if (one) found = std::max(found.value_or(0.0), *one);
  }
  return found;
}

ImportedStroke import_stroke(std::string_view bytes, const fs::path& file, const ImportOptions& options) {
  ReadStroke read = read_stroke(bytes, file, options);
  ImportedStroke out;
  ImportReport& report = out.report;
  report.rows_read = read.rows_read;
  report.rows_left_out = read.left_out_count;
  report.unit_deviation = read.unit_deviation;
  report.has_roll = read.samples.has_roll;
  report.clock = clock_of(read.samples);
  report.gaps = gaps_in(read.samples, report.clock);
  refuse_long_gaps(read, report.gaps, file, options.longest_gap);
  for (std::size_t i = 0; i < 3; ++i) report.quantum[i] = quantum_of(read.coordinates[i]);

  report.resampled = options.rate || !report.clock.is_regular;
  report.rate = options.rate.value_or(usual_rate(report.clock, read.samples.size()));
  out.samples = report.resampled ? resampled(read.samples, report.rate) : std::move(read.samples);
  if (!report.resampled) start_clock_at_zero(out.samples);
  if (options.smoothing) report.smoothing = smooth(out.samples, *options.smoothing);

  report.samples = out.samples.size();
  report.box = box_around(out.samples.position);
  add_speeds(out.samples, report);
  add_force_range(out.samples, report);
  add_warnings(read, report);
  return out;
}

std::string stroke_text(const StrokeSamples& stroke) {
  std::string text = "time_s,px_m,py_m,pz_m,";
  text += stroke.has_roll ? "qw,qx,qy,qz" : "axis_x,axis_y,axis_z";
  if (!stroke.force.empty()) text += ",mfx_N,mfy_N,mfz_N";
  const auto add = [&text](double value) {
    text += ',';
    text += NumberText(value);
  };
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    text += '\n';
    text += NumberText(stroke.time[i]);
    for (const double x : stroke.position[i]) add(x);
    const Eigen::Quaterniond& q = stroke.turn[i];
    const Vec3 axis = q * Vec3(0.0, 0.0, -1.0);
    if (stroke.has_roll) {
      for (const double part : {q.w(), q.x(), q.y(), q.z()}) add(part);
    } else {
      for (const double part : axis) add(part);
    }
    if (!stroke.force.empty()) {
      for (const double part : stroke.force[i]) add(part);
    }
  }
  return text + '\n';
}

}  // namespace hapbench
