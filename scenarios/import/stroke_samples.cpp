#include "scenarios/import/stroke_samples.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Eigen::Quaterniond;

constexpr std::size_t kMostSamples = 10'000'000;
/// Below a millimetre a jump may be jitter of a clock that wrote two samples almost at once.
constexpr double kLeastJump = 1e-3;

/// Which columns of a source hold what; empty where there is nothing.
struct ColumnMap {
  std::vector<std::size_t> time, position, orientation, force;
};

/// What may be said of the columns there are.
std::string known_columns(const SampleSource& source) {
  std::vector<std::string> shown;
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < source.names().size() && i < kMost; ++i)
    shown.push_back(fmt::format("{}{}{}", i + 1, source.names()[i].empty() ? "" : " ", source.names()[i]));
  return fmt::format("{}{}", fmt::join(shown, ", "), source.names().size() > kMost ? ", ..." : "");
}

/// Finds the columns that the options ask for.
class ColumnFinder {
 public:
  ColumnFinder(const SampleSource& source, const fs::path& file, const ImportOptions& options)
      : source_(source), file_(file), options_(options) {}

  ColumnMap map() {
    ColumnMap found;
    constexpr const char* kTime[] = {"time"};
    constexpr const char* kPosition[] = {"px", "py", "pz"};
    constexpr const char* kForce[] = {"mfx", "mfy", "mfz"};
    if (!options_.sample_rate) found.time = columns("time", kTime);
    found.position = columns("position", kPosition);
    if (found.position.empty()) fail("position", "is missing");
    if (!options_.sample_rate && found.time.empty()) fail("time", "is missing (or give --sample-rate)");
    found.orientation = columns("orientation", orientation_columns(options_.orientation));
    if (found.orientation.empty() && options_.orientation != OrientationKind::none && !is_optional("orientation"))
      fail("orientation", "is missing");
    found.force = columns("force", kForce);
    return found;
  }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  bool is_optional(const std::string& quantity) const {
    const auto& names = options_.optional_columns;
    return std::find(names.begin(), names.end(), quantity) != names.end();
  }
  [[noreturn]] void fail(const std::string& quantity, const std::string& problem) const {
    fail_in_file(file_, fmt::format("columns: {}: {}; the file has {}", quantity, problem, known_columns(source_)));
  }

  /// The group's first column and those behind it, or each by itself; empty when none is asked for.
  std::vector<std::size_t> columns(const std::string& group, std::span<const char* const> parts) {
    const bool has_parts = std::any_of(
        parts.begin(), parts.end(), [&](const char* part) { return part != group && options_.columns.contains(part); });
    std::vector<std::size_t> found;
    if (has_parts) {
      for (const char* part : parts) {
        if (!options_.columns.contains(part)) fail(part, "is missing beside others of " + group);
        found.push_back(*column(part, false));
      }
      return found;
    }
    if (parts.empty() || !options_.columns.contains(group)) return found;
    const auto first = column(group, is_optional(group));
    if (!first) {
      notes_.push_back("no columns of " + group + " as the preset names them: left out");
      return found;
    }
    for (std::size_t i = 0; i < parts.size(); ++i) found.push_back(*first + i);
    if (found.back() >= source_.names().size())
      fail(group, fmt::format("takes columns {} ... {}", *first + 1, found.back() + 1));
    return found;
  }

  std::optional<std::size_t> column(const std::string& quantity, bool may_be_missing) const {
    const std::vector<std::string>& names = source_.names();
    const std::vector<std::string>& wanted = options_.columns.at(quantity);
    for (const std::string& word : wanted) {
      for (const std::string& name : {word, word + "_x"}) {
        const auto at = std::find(names.begin(), names.end(), name);
        if (!name.empty() && at != names.end()) {
          if (std::find(at + 1, names.end(), name) != names.end())
            fail(quantity, fmt::format("two columns are named {}: give its number", quoted_word(name)));
          return static_cast<std::size_t>(at - names.begin());
        }
      }
      const auto number = whole_number(word);
      if (number && *number >= 1 && *number <= names.size()) return *number - 1;
    }
    if (may_be_missing) return std::nullopt;
    const std::string& word = wanted.empty() ? std::string() : wanted.front();
    fail(quantity, fmt::format("got {}{}", quoted_word(word), nearest_name_hint(word, names)));
  }

  const SampleSource& source_;
  const fs::path& file_;
  const ImportOptions& options_;
  std::vector<std::string> notes_;
};

double scale_of(const ImportOptions& options, const std::string& quantity) {
  const auto found = options.scale.find(quantity);
  return found == options.scale.end() ? 1.0 : found->second;
}

Quaterniond from_down_to(const Vec3& axis) {
  return Quaterniond::FromTwoVectors(Vec3(0.0, 0.0, -1.0), axis);
}

/// Makes samples of rows; `problem` says why it could not.
class SampleMaker {
 public:
  SampleMaker(const SampleSource& source, const ColumnMap& columns, const ImportOptions& options)
      : source_(source),
        columns_(columns),
        options_(options),
        kind_(columns.orientation.empty() ? OrientationKind::none : options.orientation),
        frame_(options.frame),
        tool_(from_down_to(options.tip_axis.normalized())),
        time_scale_(scale_of(options, "time")),
        position_scale_(scale_of(options, "position")),
        angle_scale_(scale_of(options, "angle")),
        force_scale_((options.force_by_tool ? -1.0 : 1.0) * scale_of(options, "force")) {}

  struct Made {
    double time;
    Vec3 recorded;  ///< position before it is turned and shifted [m]
    Vec3 position;
    Quaterniond turn;
    Vec3 force;
  };

  /// The source's present row; none with a problem.
  std::optional<Made> made() {
    problem_ = source_.problem();
    if (!problem_.empty()) return std::nullopt;
    Made out;
    const auto& rate = options_.sample_rate;
    out.time = rate ? static_cast<double>(number_++) / *rate : time_scale_ * number(columns_.time[0]);
    out.recorded = position_scale_ * vector(columns_.position);
    out.position = options_.frame * out.recorded + options_.shift;
    out.force = columns_.force.empty() ? Vec3::Zero() : Vec3(force_scale_ * (options_.frame * vector(columns_.force)));
    if (problem_.empty()) out.turn = turn();
    if (problem_.empty() && !(out.position.norm() < 1e6 && out.force.norm() < 1e9 && std::abs(out.time) < 1e12))
      problem_ = "too large a number; allowed: positions below 1e6 m, forces below 1e9 N, times below 1e12 s";
    return problem_.empty() ? std::optional(out) : std::nullopt;
  }
  const std::string& problem() const { return problem_; }
  double unit_deviation() const { return unit_deviation_; }
  bool has_roll() const { return kind_ != OrientationKind::axis && kind_ != OrientationKind::none; }

 private:
  double number(std::size_t column) {
    if (const auto value = source_.value(column)) return *value;
    if (problem_.empty()) {
      const std::string& name = source_.names()[column];
      problem_ = fmt::format("column {}{}{}: got {}; allowed: a finite number", column + 1, name.empty() ? "" : " ",
                             name, source_.shown_value(column));
    }
    return 0.0;
  }
  Vec3 vector(const std::vector<std::size_t>& columns) {
    return {number(columns[0]), number(columns[1]), number(columns[2])};
  }

  /// False, and a problem, when a norm that ought to be 1 is not.
  bool is_unit(const char* what, double norm) {
    const double deviation = std::abs(norm - 1.0);
    if (!(deviation <= kMostUnitDeviation)) {
      problem_ = fmt::format("got {} of norm {:.6g}; allowed: 1 within {:g}", what, norm, kMostUnitDeviation);
      return false;
    }
    unit_deviation_ = std::max(unit_deviation_, deviation);
    return true;
  }

  Quaterniond turn() {
    const auto& at = columns_.orientation;
    std::array<double, 9> value{};
    for (std::size_t i = 0; i < at.size(); ++i) value[i] = number(at[i]);
    if (!problem_.empty()) return Quaterniond::Identity();
    switch (kind_) {
      case OrientationKind::none:
        return from_down_to((options_.frame * options_.tip_axis).normalized());
      case OrientationKind::axis: {
        const Vec3 axis(value[0], value[1], value[2]);
        if (!(axis.norm() > 1e-12 && axis.norm() < 1e12)) {
          problem_ = fmt::format("got an axis of length {:g}; allowed: 1e-12 ... 1e12", axis.norm());
          return Quaterniond::Identity();
        }
        return from_down_to((options_.frame * axis).normalized());
      }
      case OrientationKind::quat_wxyz:
        return turned(Quaterniond(value[0], value[1], value[2], value[3]));
      case OrientationKind::quat_xyzw:
        return turned(Quaterniond(value[3], value[0], value[1], value[2]));
      case OrientationKind::axis_angle: {
        const Vec3 axis(value[0], value[1], value[2]);
        const double angle = angle_scale_ * value[3];
        // No turn needs no axis.
        if (axis.norm() == 0.0 && angle == 0.0) return turned(Quaterniond::Identity());
        if (!is_unit("a turn's axis", axis.norm())) return Quaterniond::Identity();
        return turned(Quaterniond(Eigen::AngleAxisd(angle, axis.normalized())));
      }
      case OrientationKind::matrix:
        return turned_by(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(value.data()));
    }
    return Quaterniond::Identity();
  }

  Quaterniond turned(const Quaterniond& recorded) {
    if (!is_unit("a quaternion", recorded.norm())) return Quaterniond::Identity();
    return (frame_ * recorded.normalized() * tool_).normalized();
  }

  Quaterniond turned_by(const Mat3& recorded) {
    const double deviation = (recorded.transpose() * recorded - Mat3::Identity()).cwiseAbs().maxCoeff();
    if (!(deviation <= kMostUnitDeviation && recorded.determinant() > 0.0)) {
      problem_ = fmt::format(
          "got a matrix that is no rotation; allowed: rows of length 1, perpendicular within {:g}, "
          "determinant 1",
          kMostUnitDeviation);
      return Quaterniond::Identity();
    }
    unit_deviation_ = std::max(unit_deviation_, deviation);
    return (frame_ * Quaterniond(recorded).normalized() * tool_).normalized();
  }

  const SampleSource& source_;
  const ColumnMap& columns_;
  const ImportOptions& options_;
  OrientationKind kind_;
  Quaterniond frame_, tool_;
  double time_scale_, position_scale_, angle_scale_, force_scale_;
  std::size_t number_ = 0;
  std::string problem_;
  double unit_deviation_ = 0.0;
};

/// Why a sample cannot follow those before it; empty when it can.
std::string problem_behind(const StrokeSamples& before, const SampleMaker::Made& next, double most_speed) {
  if (before.size() == 0) return "";
  const double step = next.time - before.time.back();
  if (!(step > 0.0))
    return fmt::format("got time {:.9g} s after {:.9g} s; allowed: increasing times", next.time, before.time.back());
  const double way = (next.position - before.position.back()).norm();
  if (way > kLeastJump && way > most_speed * step)
    return fmt::format("got a jump of {:.4g} mm in {:.4g} ms, {:.3g} m/s; allowed: {:g} m/s (is the scale right?)",
                       1e3 * way, 1e3 * step, way / step, most_speed);
  return "";
}

/// Faults of rows, the first ones kept.
struct Faults {
  std::vector<InputError> first;
  std::size_t count = 0;

  void add(const fs::path& file, const SampleSource& source, const std::string& problem) {
    ++count;
    if (first.size() < kMostFaults)
      first.emplace_back(InputError::Kind::relation,
                         fmt::format("{}, {} {}", file.string(), source.row_word(), source.row()), problem);
  }
};

void append(ReadStroke& stroke, const SampleMaker::Made& made, std::size_t row, bool has_force) {
  StrokeSamples& to = stroke.samples;
  Quaterniond turn = made.turn;
  // q and -q are one orientation; neighbours of one sign are the shorter way between them.
  if (to.size() > 0 && turn.dot(to.turn.back()) < 0.0) turn.coeffs() = -turn.coeffs();
  to.time.push_back(made.time);
  to.position.push_back(made.position);
  to.turn.push_back(turn);
  if (has_force) to.force.push_back(made.force);
  stroke.rows.push_back(row);
  for (std::size_t i = 0; i < 3; ++i) stroke.coordinates[i].push_back(made.recorded[static_cast<Eigen::Index>(i)]);
}

}  // namespace

ReadStroke read_stroke(std::string_view bytes, const fs::path& file, const ImportOptions& options) {
  if (!(options.tip_axis.norm() > 1e-9 && options.tip_axis.norm() < 1e9))
    throw InputError("tip_axis: allowed: a direction");
  if (options.sample_rate && !(*options.sample_rate > 0.0 && *options.sample_rate <= 1e6))
    throw InputError(fmt::format("sample_rate: got {} Hz; allowed: > 0 ... 1e6", *options.sample_rate));
  const auto source = open_samples(options.format, bytes, file, options.floats);
  ColumnFinder finder(*source, file, options);
  const ColumnMap columns = finder.map();
  SampleMaker maker(*source, columns, options);
  ReadStroke stroke;
  Faults faults;
  while (source->next()) {
    ++stroke.rows_read;
    if (stroke.samples.size() == kMostSamples) fail_in_file(file, fmt::format("more than {} samples", kMostSamples));
    const auto made = maker.made();
    const std::string problem = made ? problem_behind(stroke.samples, *made, options.most_speed) : maker.problem();
    if (problem.empty()) {
      append(stroke, *made, source->row(), !columns.force.empty());
    } else {
      faults.add(file, *source, problem);
    }
  }
  stroke.row_word = source->row_word();
  stroke.samples.has_roll = maker.has_roll();
  stroke.unit_deviation = maker.unit_deviation();
  stroke.notes = finder.notes();
  if (!source->remark().empty()) stroke.notes.push_back(source->remark());
  stroke.left_out_count = faults.count;
  for (const InputError& fault : faults.first) stroke.left_out.emplace_back(fault.what());
  if (faults.count > 0 && !options.skip_bad_rows) throw InputError::all(faults.first);
  if (stroke.samples.size() < 2)
    fail_in_file(file,
                 fmt::format("{} usable samples of {}; allowed: at least 2", stroke.samples.size(), stroke.rows_read));
  return stroke;
}

}  // namespace hapbench
