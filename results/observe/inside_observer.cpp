#include "results/observe/inside_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include "results/observe/metrics.hpp"

namespace hapbench {
namespace {

/// kMinStep: smallest distance between two checked positions on the path of the front point (struct Passage), in half
/// widths of the tool. kDepthWithin: largest allowed relative error of the depth of the tip centre.
constexpr double kMinStep = 2e-3, kDepthWithin = 0.02;
/// kMaxBlocks: largest number of blocks into which a run is divided; one pose of each block is kept for the search
/// after the run. kSettledSamples: number of poses in settled contact that are searched.
constexpr std::size_t kMaxBlocks = 16384, kSettledSamples = 12;
/// Largest number of distance evaluations in the search for the deepest step. kMaxClosedFormEvaluations holds for a
/// solid whose distance has a closed form, because an evaluation then takes a tenth of the time.
constexpr std::size_t kMaxEvaluations = 8000, kMaxClosedFormEvaluations = 100000;
/// The largest bound is the largest upper bound of the depth in a step that has not been searched. If the largest bound
/// still exceeds kUselessBound times the deepest known depth after kMaxEvaluations evaluations, the error exceeds the
/// depth itself. The search then continues until the largest bound is at most kUsefulBound times the deepest known
/// depth, or until kMaxExtendedEvaluations evaluations were made.
constexpr std::size_t kMaxExtendedEvaluations = 32000;
constexpr double kUselessBound = 2.0, kUsefulBound = 1.1;
/// kSharedBound: if the tip centre [half widths] and the axis of every pose in a range of blocks differ by less than
/// kSharedBound from the middle pose of the range, the range gets a fine bound (InsideBound::at). Otherwise the range
/// gets a coarse bound. A single block always gets a fine bound. kSamePose: if no point of the tool moves by more than
/// kSamePose [half widths] between the middle pose and any other pose of a range, one search is enough for the range.
constexpr double kSharedBound = 0.1, kSamePose = 0.01;

/// kDeepContact: smallest contact depth at which the tip centre is part of the core [half widths]. At smaller depths
/// the tip centre is not part of the core, because the tip centre of a flat tip lies inside the solid even in a shallow
/// contact. kCoreStep: smallest distance between two checked points on the core, and between two checked positions of
/// the core on its path [half widths].
constexpr double kDeepContact = 0.9, kCoreStep = 5e-3;
/// Smallest contact depth at which the core is checked, relative to the smallest radius of the tool, such as the radius
/// of a neck. kCheckDepth is a little smaller than kDeepContact, because the deepest point of the core may lie in a gap
/// between the surface points. These gaps are a few fifths of the smallest radius wide.
constexpr double kCheckDepth = 0.8;
/// The core ends where the axis is closer than this to the body's surface [half widths], as in a bent body.
constexpr double kThinnest = 0.05;
/// Number of positions on the axis at which the tool's thickness is computed.
constexpr std::size_t kCoreSamples = 256;
constexpr std::size_t kMaxSegments = 8;  ///< maximum number of segments of the core inside the solid at one time
/// kMaxAxisPoints: maximum number of points of the axis whose distances from the surface are kept for the next check.
/// kReusedFraction: a kept distance is used again if the point has moved by less than this fraction of the distance.
constexpr std::size_t kMaxAxisPoints = 256;
constexpr double kReusedFraction = 0.25;
constexpr double kMaxSteps = 256.0;  ///< maximum number of checked positions on the path of one time step

SolidSide side_of(const SurfaceDistance& phi) noexcept {
  return !phi.known ? SolidSide::unknown : phi.value < 0.0 ? SolidSide::inside : SolidSide::outside;
}

/// Returns true if two normals are more than 90 degrees apart, by more than rounding.
bool are_opposed(const Vec3& a, const Vec3& b) noexcept {
  return a.dot(b) < -1e-3;
}

}  // namespace

void InsideDepths::add(const InsideDepths& trial) {
  const double deepest = std::max(max_bound() + max_within, trial.max_bound() + trial.max_within);
  max = std::max(max, trial.max);  // std::optional: an empty value compares less than any number
  searched = std::max(searched, trial.searched);
  max_within = deepest - max_bound();
  settled_within = std::max(settled_within, trial.settled_within);
  settled.insert(settled.end(), trial.settled.begin(), trial.settled.end());
  rows += trial.rows;
  centre_inside += trial.centre_inside;
}

std::optional<double> InsideDepths::settled_median() const {
  if (settled.empty()) return std::nullopt;
  std::vector<double> sorted = settled;
  std::sort(sorted.begin(), sorted.end());
  return 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
}

void InsideDepths::report(Section& s, bool has_settled) const {
  s.metric(
       "inside_max_m", "m",
       "largest distance of the tool's deepest point below the environment's surface over all steps (with "
       "record.inside: over the recorded steps, largest inside_m of trajectory.csv); the true maximum exceeds this "
       "value by at most the metric's tolerance (tolerances of summary.json), without a tolerance by at most 2 % of "
       "the value and 2 % of the tool's half width; no value for springs, and beyond the boundary edges of an open "
       "surface",
       max, Better::less)
      .within(InsideSearch::kTolerance, max_within);
  s.metric(
       "inside_settled_m", "m",
       "median distance of the tool's deepest point below the environment's surface, over up to twelve evenly spread "
       "steps in settled contact (with record.inside: median inside_m of trajectory.csv over all recorded steps in "
       "settled contact); no value if "
       "settled_s < 1/30 s",
       has_settled ? settled_median() : std::nullopt, Better::less)
      .within(InsideSearch::kTolerance, settled_within);
  s.metric(
      "centre_inside_share", "1",
      "fraction of the steps in which the tip centre is below the surface (mean of centre_inside of trajectory.csv "
      "with record.inside, without empty cells); the tip centre of a flat tip is below the surface whenever the tip is "
      "pressed in",
      per(centre_inside, rows), Better::less);
}

double core_offset(const ToolShape& tool) {
  ContactBuffer tip(1);
  tip.push(0, Vec3::Zero(), Vec3::UnitZ());
  tool.surface_constraints(ToolPose{}, Vec3::Zero(), 0.0, tip);
  return std::clamp(tool.half_width() - tip.depth[0], 0.0, tool.half_width());
}

CorePassage::CorePassage(const ToolShape& tool, std::shared_ptr<const Solid> solid)
    : solid_(std::move(solid)), width_(tool.half_width()) {
  const double back = core_offset(tool);
  shallow_start_ = -kDeepContact * back;
  far_end_ = 0.0;
  for (const ProfilePoint& p : tool.outline()) far_end_ = std::min(far_end_, p.s);
  const ToolPose pose;
  ContactBuffer axis(kCoreSamples);
  const auto axial_position = [this](std::size_t i) { return far_end_ * static_cast<double>(i) / (kCoreSamples - 1); };
  for (std::size_t i = 0; i < kCoreSamples; ++i) axis.push(0, axial_position(i) * pose.axis, Vec3::UnitZ());
  tool.surface_constraints(pose, Vec3::Zero(), 0.0, axis);
  double thinnest = width_;
  const double end = far_end_ + width_;  // beyond this position, the far end of the tool is nearer than its side
  for (std::size_t i = 0; i < kCoreSamples; ++i) {
    const double s = axial_position(i);
    if (s > -back || s < end) continue;
    if (axis.depth[i] < kThinnest * width_) {
      far_end_ = s;
      break;
    }
    thinnest = std::min(thinnest, axis.depth[i]);
  }
  check_depth_ = kCheckDepth * thinnest;
  check_displacement_ = (1.0 - kDeepContact) * thinnest;
  segments_.reserve(kMaxSegments);
  last_segments_.reserve(kMaxSegments);
  axis_points_.reserve(kMaxAxisPoints);
  last_axis_points_.reserve(kMaxAxisPoints);
}

/// Returns the signed distance of a point with coordinate s on the axis. A point that has moved by less than
/// kReusedFraction of its last distance is not evaluated again: it is on the same side, and the last distance minus the
/// motion is a lower bound of its distance. Otherwise, the sum of the last distance and the motion is an upper bound
/// for the search. Precondition: s decreases from call to call during a check.
SurfaceDistance CorePassage::distance_at(const Vec3& point, double s) noexcept {
  const std::vector<AxisPoint>& last = last_axis_points_;
  const auto offset = [&](std::size_t i) { return std::abs(last[i].s - s); };
  while (next_axis_point_ + 1 < last.size() && offset(next_axis_point_ + 1) <= offset(next_axis_point_))
    ++next_axis_point_;
  const AxisPoint* near = last.empty() ? nullptr : &last[next_axis_point_];
  const auto keep = [this](const AxisPoint& evaluated) {
    if (axis_points_.size() < kMaxAxisPoints) axis_points_.push_back(evaluated);
  };
  if (near != nullptr && near->known) {
    const double moved = (point - near->distance.point).norm(), size = std::abs(near->distance.value);
    if (moved < kReusedFraction * size) {
      keep({s, near->distance, true});
      return {std::copysign(size - moved, near->distance.value)};
    }
  }
  const SurfaceDistance phi = solid_->at(point, near == nullptr ? nullptr : &near->distance);
  keep({s, {point, phi.value}, phi.known});
  return phi;
}

Vec3 CorePassage::normal_at(const Vec3& point) const noexcept {
  return solid_->gradient(point, kGradientStep * width_);
}

/// Checks the core at positions along its path from the pose of the previous step. Between two checked positions the
/// core cannot meet the surface.
void CorePassage::check_core(const ToolPose& pose, double deepest_contact, double time) noexcept {
  const Vec3 displacement = began_ ? Vec3(pose.position - position_) : Vec3::Zero();
  const Vec3 axis_change = began_ ? Vec3(pose.axis - axis_) : Vec3::Zero();
  const double length = displacement.norm() - far_end_ * axis_change.norm();
  if (!std::isfinite(length)) return;
  if (free_distance_ > length) {
    free_distance_ -= length;
    return;
  }
  const double front = deepest_contact >= kDeepContact * width_ ? 0.0 : shallow_start_;
  const double min_step = std::max(kCoreStep * width_, length / kMaxSteps);
  double done = std::min(free_distance_, length);
  for (;;) {
    const double rest = length > 0.0 ? 1.0 - done / length : 0.0;
    const Vec3 position = pose.position - rest * displacement, axis = (pose.axis - rest * axis_change).normalized();
    const double free_step = find_segments(position, axis, front);
    compare(position, axis, time);
    std::swap(last_segments_, segments_);
    continues_ = true;
    if (event_ || done >= length) {
      free_distance_ = std::max(free_step, kCoreStep * width_);
      return;
    }
    done = std::min(length, done + std::max(free_step, min_step));
  }
}

/// Finds the segments of the core inside the solid. Returns a lower bound of the distance that the core can move before
/// it meets the surface [m].
// NOLINTNEXTLINE(readability-function-cognitive-complexity): one walk along the axis.
double CorePassage::find_segments(const Vec3& position, const Vec3& axis, double front) noexcept {
  segments_.clear();
  std::swap(axis_points_, last_axis_points_);
  axis_points_.clear();
  next_axis_point_ = 0;
  SolidSide before = SolidSide::unknown;
  double s = front, nearest = std::numeric_limits<double>::infinity();
  Vec3 last = position + s * axis;
  for (;;) {
    const Vec3 point = position + s * axis;
    const SurfaceDistance phi = distance_at(point, s);
    const SolidSide side = side_of(phi);
    nearest = std::min(nearest, std::abs(phi.value));
    // Begin, extend or end a segment.
    if (side == SolidSide::inside) {
      if (before != SolidSide::inside) {
        if (segments_.size() == kMaxSegments) break;
        segments_.push_back({s, s, {}, {}, phi.value, point});
        if (before == SolidSide::outside) segments_.back().face_high = normal_at(last);
      }
      Segment& segment = segments_.back();
      segment.low = s;
      if (phi.value < segment.deepest) {
        segment.deepest = phi.value;
        segment.deepest_position = point;
      }
    } else if (before == SolidSide::inside && side == SolidSide::outside) {
      segments_.back().face_low = normal_at(point);
    }
    if (!(s > far_end_)) break;
    before = side;
    last = point;
    // Move along the axis by the distance to the surface.
    s = std::max(far_end_, s - std::max(std::abs(phi.value), kCoreStep * width_));
  }
  return 0.5 * nearest;  // between two evaluated points the surface may be at half the evaluated distance
}

/// Returns the first segment of the last check that overlaps `next`; null if no segment of the last check overlaps it.
/// Marks all segments of the last check that overlap `next` as continued.
const CorePassage::Segment* CorePassage::continued_by(const Segment& next) noexcept {
  const Segment* first = nullptr;
  for (Segment& old : last_segments_) {
    if (old.low > next.high || next.low > old.high) continue;
    old.continued = true;
    if (first == nullptr) first = &old;
  }
  return first;
}

/// Detects a passage. Matches each segment that is inside now with a segment of the last check, from which it
/// inherits the face of entry.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): one case after the other for each segment.
void CorePassage::compare(const Vec3& position, const Vec3& axis, double time) noexcept {
  const auto through = [this, time](const Vec3& entered, const Vec3& left, bool at_once) {
    if (!event_) event_ = {time, entered, left, at_once};
  };
  const auto position_at = [&](double s) { return Vec3(position + s * axis); };
  for (Segment& next : segments_) {
    if (next.face_low && next.face_high && are_opposed(*next.face_low, *next.face_high))
      through(position_at(next.high), position_at(next.low), true);
    const Segment* previous = continued_by(next);
    if (previous == nullptr) {
      next.entered = next.deepest_position;
      next.normal = normal_at(next.deepest_position);
      next.entered_low = next.low;
      next.entered_high = next.high;
      continue;
    }
    next.entered = previous->entered;
    next.normal = previous->normal;
    // A segment whose end leaves by a face opposed to the face of entry has passed through, unless the same end had
    // entered by this opposed face.
    const bool away_low = next.face_low && are_opposed(*next.face_low, next.normal);
    const bool away_high = next.face_high && are_opposed(*next.face_high, next.normal);
    if (away_low && next.low > previous->entered_low) through(next.entered, position_at(next.low), false);
    if (away_high && next.high < previous->entered_high) through(next.entered, position_at(next.high), false);
    next.entered_low = away_low ? std::max(previous->entered_low, next.low) : next.low;
    next.entered_high = away_high ? std::min(previous->entered_high, next.high) : next.high;
  }
  if (!continues_) return;
  // A segment of the last check that is no longer inside has passed through if it left by an opposed face.
  for (const Segment& old : last_segments_) {
    if (old.continued) continue;
    const Vec3 middle = position_at(0.5 * (old.entered_low + old.entered_high));
    const SurfaceDistance phi = solid_->at(middle);
    if (phi.known && phi.value > 0.0 && are_opposed(normal_at(middle), old.normal)) through(old.entered, middle, false);
  }
}

PoseSamples::Sample PoseSamples::joined(const Sample& a, const Sample& b) const noexcept {
  const auto& [kept, other] = b.key > a.key ? std::tie(b, a) : std::tie(a, b);
  return {kept.pose, kept.key,
          std::max(kept.max_motion, other.max_motion + tool_.displacement_bound(kept.pose, other.pose))};
}

void PoseSamples::begin_block(const ToolPose& pose, double key) noexcept {
  if (samples_.size() == max_samples_) {
    for (std::size_t i = 0; i < max_samples_ / 2; ++i) samples_[i] = joined(samples_[2 * i], samples_[2 * i + 1]);
    samples_.resize(max_samples_ / 2);
    rows_of_block_ *= 2;
  }
  rows_left_ = rows_of_block_ - 1;
  samples_.push_back({pose, key});
}

InsideObserver::InsideObserver(std::shared_ptr<const ToolShape> tool, std::shared_ptr<const Solid> solid,
                               const MetricsObserver* metrics, std::uint64_t every, std::uint64_t steps)
    : tool_(std::move(tool)),
      solid_(std::move(solid)),
      settled_by_(metrics),
      every_(every),
      search_(*tool_, *solid_),
      back_(core_offset(*tool_)),
      core_passage_(*tool_, solid_),
      deepest_(kMaxBlocks, *tool_),
      settled_(kSettledSamples, *tool_) {
  if (every_ > 0) depths_.settled.reserve(steps / every_ + 1);
}

void InsideObserver::on_step(const StepRecord& record) noexcept {
  const ToolPose& pose = record.tool.pose;
  const double free2 = side_ == SolidSide::inside ? tip_free2_inside_ : tip_free2_;
  if (!((pose.position - tip_checked_).squaredNorm() < free2)) check_tip(record);
  if (tip_phi_.known) {
    ++depths_.rows;
    if (tip_phi_.value < 0.0) ++depths_.centre_inside;
  }
  // Check whether the front point or the rest of the core (struct Passage) has passed through the surface.
  const Vec3 core = pose.position - back_ * pose.axis;
  const double length = (core - core_).norm();
  core_passage_.add(pose, record.force.depth_max, began_ ? length : 0.0, record.time);
  if (free_distance_ > length) {
    free_distance_ -= length;
    core_ = core;
  } else {
    march(core, began_ ? length : 0.0, record.time);
  }
  // Search the depth now if it is recorded, and keep the pose for the search after the run.
  const bool settled = settled_by_ != nullptr && settled_by_->in_settled_contact();
  if (every_ > 0) {
    depth_ = record.step % every_ == 0 ? search_.depth(pose) : std::nullopt;
    depths_.max = std::max(depths_.max, depth_);
    if (depth_ && settled) depths_.settled.push_back(*depth_);
  }
  // The key of a pose is the depth of the deepest contact while the front point (struct Passage) is outside of the
  // solid. While the front point is inside, the key is the depth of the tip centre plus the half width.
  const bool deep = side_ == SolidSide::inside;
  deepest_.add(pose, deep ? tool_->half_width() + std::max(0.0, -tip_phi_.value) : record.force.depth_max);
  if (settled && every_ == 0) settled_.add(pose, 0.0);
}

void InsideObserver::check_tip(const StepRecord& record) noexcept {
  const Vec3& tip = record.tool.pose.position;
  const KnownDistance last{tip_checked_, tip_phi_.value};
  tip_phi_ = solid_->at(tip, began_ ? &last : nullptr);
  tip_checked_ = tip;
  passage_.last_depth = tip_phi_.known ? -tip_phi_.value : 0.0;
  const double width = tool_->half_width(), size = std::abs(tip_phi_.value);
  // Evaluate more often, after a motion of 2 % of the distance, in two cases: the tip centre is deep and its depth is
  // reported, or the tip centre is beyond the border of the surface, where the distance is not reliable.
  const double near = kDepthWithin * size;
  const bool below = tip_phi_.value < 0.0;
  tip_free2_ = tip_phi_.known && !(below && size > width) ? size * size : near * near;
  tip_free2_inside_ = tip_phi_.known && !below ? size * size : near * near;
  if (!tip_phi_.known || !below) return;
  passage_.deepest = std::max(passage_.deepest, size);
  if (!passage_.deep && size > width) passage_.deep = {record.time, tip};
}

/// Checks the front point at positions along its path from its last position. Between two checked positions the front
/// point cannot meet the surface.
void InsideObserver::march(const Vec3& point, double length, double time) noexcept {
  const Vec3 from = std::exchange(core_, point);
  const Vec3 displacement = point - from;
  const double min_step = std::max(kMinStep * tool_->half_width(), length / kMaxSteps);
  double done = std::min(free_distance_, length);
  for (;;) {
    const Vec3 here = length > 0.0 ? Vec3(from + done / length * displacement) : point;
    const SurfaceDistance phi = solid_->at(here, core_distance_ ? &*core_distance_ : nullptr);
    core_distance_ = {here, phi.value};
    update_side(here, phi, time);
    began_ = true;
    if (done >= length || !std::isfinite(done)) {
      free_distance_ = std::abs(phi.value);
      return;
    }
    done = std::min(length, done + std::max(std::abs(phi.value), min_step));
  }
}

void InsideObserver::update_side(const Vec3& point, const SurfaceDistance& phi, double time) noexcept {
  const double step = kGradientStep * tool_->half_width();
  const SolidSide before = std::exchange(side_, side_of(phi));
  // Record the side in the first and in the last step.
  if (!began_) passage_.began_inside = side_ == SolidSide::inside;
  passage_.ends_inside = side_ == SolidSide::inside;
  // Entry: remember the normal of the face.
  if (side_ == SolidSide::inside && before == SolidSide::outside) {
    entry_normal_ = solid_->gradient(outside_, step);
    if (!passage_.left) passage_.entered = point;
  }
  // Exit by an opposed face: the front point has passed through.
  if (side_ == SolidSide::outside && before == SolidSide::inside && entry_normal_ &&
      are_opposed(*entry_normal_, solid_->gradient(point, step)) && !passage_.left) {
    passage_.left = {time, point};
  }
  if (side_ != SolidSide::inside) entry_normal_.reset();
  if (side_ == SolidSide::outside) outside_ = point;
}

InsideDepths InsideObserver::depths() {
  InsideDepths depths = depths_;
  const double width = tool_->half_width(), error = search_.error();
  depths.max_within = depths.settled_within = InsideSearch::kTolerance * width + error;
  if (every_ > 0) {
    InsideSearch search(*tool_, *solid_);
    InsideDepths found;
    find_deepest(search, found);
    depths.searched = found.max;
    return depths;
  }
  const double rest = find_deepest(search_, depths);
  depths.searched = depths.max;
  for (const auto& sample : settled_.all()) {
    if (const auto depth = search_.depth(sample.pose)) depths.settled.push_back(*depth);
  }
  for (const double depth : depths.settled) depths.max = std::max(depths.max, std::optional(depth));
  if (rest > 0.0) depths.max_within = rest - depths.max_bound() + error;
  return depths;
}

/// Branch and bound over the run for the deepest step. Halves the range of blocks with the largest bound, as long as
/// the bound is larger than the deepest known depth. In a range of nearly equal poses, searches one pose. Returns an
/// upper bound of the depth in steps that were not searched [m]; 0 if, within the tolerance, no such step is deeper
/// than the deepest known step.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): one branch and bound; its parts are the local functions.
double InsideObserver::find_deepest(InsideSearch& inside_search, InsideDepths& depths) {
  struct Segment {
    std::size_t first, end;
    /// max_motion: largest distance of a point of the tool from its position in the middle pose [m]. bound: upper bound
    /// of the depth [m].
    double max_motion, bound;
    bool operator<(const Segment& other) const { return bound < other.bound; }
  };
  const std::vector<PoseSamples::Sample>& parts = deepest_.all();
  if (parts.empty()) return 0.0;
  const double width = tool_->half_width();
  const auto search = [&](const ToolPose& pose, double max_motion) {
    const double tolerance = InsideSearch::kTolerance - max_motion / width;
    depths.max = std::max(depths.max, inside_search.depth(pose, depths.max.value_or(0.0), tolerance));
  };
  const auto depth_threshold = [&] { return depths.max_bound() + InsideSearch::kTolerance * width; };
  // Search the pose with the largest key first.
  search(std::ranges::max_element(parts, {}, &PoseSamples::Sample::key)->pose, 0.0);
  InsideBound bound(*tool_, *solid_);
  // Bounds the depth of the tool over all poses in the blocks `first` to `end` - 1.
  const auto bounded = [&](std::size_t first, std::size_t end) {
    const ToolPose& pose = parts[(first + end) / 2].pose;
    Segment s{first, end, 0.0, 0.0};
    double displacement = 0.0, axis_change = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const PoseSamples::Sample& sample = parts[i];
      displacement = std::max(displacement, sample.max_motion + (sample.pose.position - pose.position).norm());
      axis_change = std::max(axis_change, sample.max_motion / tool_->reach() + (sample.pose.axis - pose.axis).norm());
      s.max_motion = std::max(s.max_motion, sample.max_motion + tool_->displacement_bound(pose, sample.pose));
    }
    const bool last = end - first == 1;
    s.bound =
        last || (displacement < kSharedBound * width && axis_change < kSharedBound)
            ? bound.at(pose, displacement, axis_change, depth_threshold(), last && s.max_motion > kSamePose * width)
            : bound.coarse_bound_at(pose, displacement, axis_change);
    return s;
  };
  std::size_t max_evaluations = solid_->bytes() > 0 ? kMaxEvaluations : kMaxClosedFormEvaluations;
  bool is_extended = false;
  // Returns true if the search ends because of its cost or precision, although the largest bound exceeds the deepest
  // known depth.
  const auto is_enough = [&](double largest_bound) {
    if (is_extended && largest_bound <= kUsefulBound * depths.max_bound()) return true;
    if (bound.looks() + inside_search.looks() < max_evaluations) return false;
    const bool extends = !is_extended && max_evaluations < kMaxExtendedEvaluations && depths.max_bound() > 0.0 &&
                         largest_bound > kUselessBound * depths.max_bound();
    if (extends) max_evaluations = kMaxExtendedEvaluations;
    is_extended = is_extended || extends;
    return !extends;
  };
  // Refine the range of blocks with the largest bound, until no range can contain a deeper pose.
  std::priority_queue<Segment> open;
  open.push(bounded(0, parts.size()));
  double rest = 0.0;  // largest bound of ranges that can neither be halved nor searched
  while (!open.empty() && open.top().bound > depth_threshold() && !is_enough(open.top().bound)) {
    const Segment s = open.top();
    open.pop();
    const std::size_t middle = (s.first + s.end) / 2;
    if (s.max_motion <= kSamePose * width) {
      search(parts[middle].pose, s.max_motion);
    } else if (s.end - s.first == 1) {
      rest = std::max(rest, s.bound);
    } else {
      open.push(bounded(s.first, middle));
      open.push(bounded(middle, s.end));
    }
  }
  if (!open.empty()) rest = std::max(rest, open.top().bound);
  return rest > depth_threshold() ? rest : 0.0;
}

}  // namespace hapbench
