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

/// Relative to the tool's half width: the least step in which the core's way is looked at; relative to the depth: what
/// a depth of the tip centre may be wrong by.
constexpr double kLeastStep = 2e-3, kDepthWithin = 0.02;
/// Parts of a run of which a row is kept, and rows in settled contact whose deepest point is looked for after it.
constexpr std::size_t kParts = 16384, kSettled = 12;
/// Look-ups for the deepest row; a solid in closed form answers ten times as fast.
constexpr std::size_t kMostLooks = 8000, kMostLooksAtForms = 100000;
/// Rows are bound together where the tip centre's places differ by less than this in half widths, and the axes in
/// length; one search is enough for rows in which no point of the tool differs by more than this.
constexpr double kTogether = 0.1, kAlike = 0.01;

/// Relative to the half width: the depth of a contact from which on the tip centre itself is part of the core, as a
/// flat tip's is in the surface at any depth; the least step along the core and of its way.
constexpr double kDeep = 0.9, kCoreStep = 5e-3;
/// Relative to where the tool is thinnest, as at a neck: the depth of a contact from which on the core is looked at. A
/// little less than kDeep, because points of a surface, which are some fifths of that apart, may miss the core.
constexpr double kLookFrom = 0.8;
/// The core ends where the axis comes so close to the body's surface, in half widths, as in a bent body.
constexpr double kThinnest = 0.05;
constexpr std::size_t kCoreSamples = 256;  ///< of the tool's thickness
constexpr std::size_t kMostStretches = 8;  ///< of the core that are inside at one time
constexpr double kMostStepsOfWay = 256.0;  ///< in which the way of a row is followed through a solid

SolidSide side_of(const SurfaceDistance& phi) noexcept {
  return !phi.known ? SolidSide::unknown : phi.value < 0.0 ? SolidSide::inside : SolidSide::outside;
}

/// True for the normals of faces that look away from each other, by more than the rounding of a right angle.
bool look_away(const Vec3& a, const Vec3& b) noexcept {
  return a.dot(b) < -1e-3;
}

}  // namespace

void InsideDepths::add(const InsideDepths& trial) {
  const double deepest = std::max(searched_max() + max_within, trial.searched_max() + trial.max_within);
  max = std::max(max, trial.max);  // an empty optional is less than any number
  max_within = deepest - searched_max();
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

void InsideDepths::tell(Section& s, bool has_settled) const {
  s.metric(
       "inside_max_m", "m",
       "largest distance of the tool's deepest point below the environment's surface over all steps (with "
       "record.inside: over the recorded steps); the true maximum exceeds it by at most 2 % of itself and of the "
       "tool's half width, or by its tolerance if one is given; no value for springs and beyond the border of an open "
       "surface",
       max, Better::less)
      .within(InsideSearch::kTolerance, max_within);
  s.metric(
       "inside_settled_m", "m",
       "median distance of the tool's deepest point below the environment's surface, over up to twelve evenly spread "
       "steps in settled contact (with record.inside: over all recorded steps in settled contact); no value if "
       "settled_s < 1/30 s",
       has_settled ? settled_median() : std::nullopt, Better::less)
      .within(InsideSearch::kTolerance, settled_within);
  s.metric(
      "centre_inside_share", "1",
      "fraction of the steps in which the tip centre is below the surface; the tip centre of a flat tip is below it "
      "whenever the tip is pressed in",
      per(centre_inside, rows), Better::less);
}

double way_to_core(const ToolShape& tool) {
  ContactBuffer tip(1);
  tip.push(0, Vec3::Zero(), Vec3::UnitZ());
  tool.surface_constraints(ToolPose{}, Vec3::Zero(), 0.0, tip);
  return std::clamp(tool.half_width() - tip.depth[0], 0.0, tool.half_width());
}

CorePassage::CorePassage(const ToolShape& tool, std::shared_ptr<const Solid> solid)
    : solid_(std::move(solid)), width_(tool.half_width()) {
  const double back = way_to_core(tool);
  shallow_ = -kDeep * back;
  far_ = 0.0;
  for (const ProfilePoint& p : tool.outline()) far_ = std::min(far_, p.s);
  const ToolPose pose;
  ContactBuffer axis(kCoreSamples);
  const auto place = [this](std::size_t i) { return far_ * static_cast<double>(i) / (kCoreSamples - 1); };
  for (std::size_t i = 0; i < kCoreSamples; ++i) axis.push(0, place(i) * pose.axis, Vec3::UnitZ());
  tool.surface_constraints(pose, Vec3::Zero(), 0.0, axis);
  double thinnest = width_;
  const double end = far_ + width_;  // behind it, the far end is nearest
  for (std::size_t i = 0; i < kCoreSamples; ++i) {
    const double s = place(i);
    if (s > -back || s < end) continue;
    if (axis.depth[i] < kThinnest * width_) {
      far_ = s;
      break;
    }
    thinnest = std::min(thinnest, axis.depth[i]);
  }
  looks_from_ = kLookFrom * thinnest;
  looks_from_way_ = (1.0 - kDeep) * thinnest;
  now_.reserve(kMostStretches);
  inside_.reserve(kMostStretches);
}

Vec3 CorePassage::normal_at(const Vec3& place) const noexcept {
  return solid_->gradient(place, kNormalsOver * width_);
}

/// Follows the core from the row before in steps on which it cannot meet the surface.
void CorePassage::look(const ToolPose& pose, double deepest_contact, double time) noexcept {
  const Vec3 moved = began_ ? Vec3(pose.position - position_) : Vec3::Zero();
  const Vec3 turned = began_ ? Vec3(pose.axis - axis_) : Vec3::Zero();
  const double way = moved.norm() - far_ * turned.norm();
  if (!std::isfinite(way)) return;
  if (free_way_ > way) {
    free_way_ -= way;
    return;
  }
  const double front = deepest_contact >= kDeep * width_ ? 0.0 : shallow_;
  const double least = std::max(kCoreStep * width_, way / kMostStepsOfWay);
  double done = std::min(free_way_, way);
  for (;;) {
    const double rest = way > 0.0 ? 1.0 - done / way : 0.0;
    const Vec3 position = pose.position - rest * moved, axis = (pose.axis - rest * turned).normalized();
    const double clear = find_inside(position, axis, front);
    compare(position, axis, time);
    std::swap(inside_, now_);
    follows_ = true;
    if (event_ || done >= way) {
      free_way_ = std::max(clear, kCoreStep * width_);
      return;
    }
    done = std::min(way, done + std::max(clear, least));
  }
}

/// Finds the stretches of this look and returns a way on which the core cannot meet the surface [m].
double CorePassage::find_inside(const Vec3& position, const Vec3& axis, double front) noexcept {
  now_.clear();
  SolidSide before = SolidSide::unknown;
  double s = front, nearest = std::numeric_limits<double>::infinity();
  Vec3 last = position + s * axis;
  for (;;) {
    const Vec3 place = position + s * axis;
    const SurfaceDistance phi = solid_->at(place);
    const SolidSide side = side_of(phi);
    nearest = std::min(nearest, std::abs(phi.value));
    if (side == SolidSide::inside) {
      if (before != SolidSide::inside) {
        if (now_.size() == kMostStretches) break;
        now_.push_back({s, s, {}, {}, phi.value, place});
        if (before == SolidSide::outside) now_.back().face_high = normal_at(last);
      }
      Stretch& stretch = now_.back();
      stretch.low = s;
      if (phi.value < stretch.deepest) {
        stretch.deepest = phi.value;
        stretch.deepest_place = place;
      }
    } else if (before == SolidSide::inside && side == SolidSide::outside) {
      now_.back().face_low = normal_at(place);
    }
    if (!(s > far_)) break;
    before = side;
    last = place;
    s = std::max(far_, s - std::max(std::abs(phi.value), kCoreStep * width_));
  }
  return 0.5 * nearest;  // between two looks it may be half as far
}

/// Matches the stretches that are inside now with those of the look before, which hand on the face of their entry.
void CorePassage::compare(const Vec3& position, const Vec3& axis, double time) noexcept {
  const auto through = [this, time](const Vec3& entered, const Vec3& left, bool at_once) {
    if (!event_) event_ = {time, entered, left, at_once};
  };
  for (Stretch& next : now_) {
    const auto place = [&](double s) { return Vec3(position + s * axis); };
    if (next.face_low && next.face_high && look_away(*next.face_low, *next.face_high))
      through(place(next.high), place(next.low), true);
    const Stretch* was = nullptr;
    for (Stretch& old : inside_) {
      if (old.low > next.high || next.low > old.high) continue;
      old.goes_on = true;
      if (was == nullptr) was = &old;
    }
    if (was == nullptr) {
      next.entered = next.deepest_place;
      next.normal = normal_at(next.deepest_place);
      next.own_low = next.low;
      next.own_high = next.high;
      continue;
    }
    next.entered = was->entered;
    next.normal = was->normal;
    // An end that comes out by a face opposite to the entry's has gone through, unless that end had come in by it.
    const bool away_low = next.face_low && look_away(*next.face_low, next.normal);
    const bool away_high = next.face_high && look_away(*next.face_high, next.normal);
    if (away_low && next.low > was->own_low) through(next.entered, place(next.low), false);
    if (away_high && next.high < was->own_high) through(next.entered, place(next.high), false);
    next.own_low = away_low ? std::max(was->own_low, next.low) : next.low;
    next.own_high = away_high ? std::min(was->own_high, next.high) : next.high;
  }
  if (!follows_) return;
  for (const Stretch& old : inside_) {
    if (old.goes_on) continue;
    const Vec3 middle = position + 0.5 * (old.own_low + old.own_high) * axis;
    const SurfaceDistance phi = solid_->at(middle);
    if (phi.known && phi.value > 0.0 && look_away(normal_at(middle), old.normal)) through(old.entered, middle, false);
  }
}

PoseSamples::Sample PoseSamples::joined(const Sample& a, const Sample& b) const noexcept {
  const auto& [kept, other] = b.key > a.key ? std::tie(b, a) : std::tie(a, b);
  return {kept.pose, kept.key, std::max(kept.way, other.way + tool_.moved_at_most(kept.pose, other.pose))};
}

void PoseSamples::begin_part(const ToolPose& pose, double key) noexcept {
  if (samples_.size() == most_) {
    for (std::size_t i = 0; i < most_ / 2; ++i) samples_[i] = joined(samples_[2 * i], samples_[2 * i + 1]);
    samples_.resize(most_ / 2);
    rows_of_part_ *= 2;
  }
  rows_left_ = rows_of_part_ - 1;
  samples_.push_back({pose, key});
}

InsideObserver::InsideObserver(std::shared_ptr<const ToolShape> tool, std::shared_ptr<const Solid> solid,
                               const MetricsObserver* metrics, std::uint64_t every, std::uint64_t steps)
    : tool_(std::move(tool)),
      solid_(std::move(solid)),
      settled_by_(metrics),
      every_(every),
      search_(*tool_, *solid_),
      back_(way_to_core(*tool_)),
      core_passage_(*tool_, solid_),
      deepest_(kParts, *tool_),
      settled_(kSettled, *tool_) {
  if (every_ > 0) depths_.settled.reserve(steps / every_ + 1);
}

void InsideObserver::on_step(const StepRecord& record) noexcept {
  const ToolPose& pose = record.tool.pose;
  const double free2 = side_ == SolidSide::inside ? tip_free2_inside_ : tip_free2_;
  if (!((pose.position - tip_looked_).squaredNorm() < free2)) look_at_tip(record);
  if (tip_phi_.known) {
    ++depths_.rows;
    if (tip_phi_.value < 0.0) ++depths_.centre_inside;
  }
  const Vec3 core = pose.position - back_ * pose.axis;
  const double length = (core - core_).norm();
  core_passage_.add(pose, record.force.depth_max, began_ ? length : 0.0, record.time);
  if (free_way_ > length) {
    free_way_ -= length;
    core_ = core;
  } else {
    march(core, began_ ? length : 0.0, record.time);
  }
  const bool settled = settled_by_ != nullptr && settled_by_->in_settled_contact();
  if (every_ > 0) {
    depth_ = record.step % every_ == 0 ? search_.depth(pose) : std::nullopt;
    depths_.max = std::max(depths_.max, depth_);
    if (depth_ && settled) depths_.settled.push_back(*depth_);
    return;
  }
  // The depth of contacts tells until the core is inside, and from there on that of the tip centre.
  const bool deep = side_ == SolidSide::inside;
  deepest_.add(pose, deep ? tool_->half_width() + std::max(0.0, -tip_phi_.value) : record.force.depth_max);
  if (settled) settled_.add(pose, 0.0);
}

void InsideObserver::look_at_tip(const StepRecord& record) noexcept {
  const Vec3& tip = record.tool.pose.position;
  tip_phi_ = solid_->at(tip);
  tip_looked_ = tip;
  passage_.last_depth = tip_phi_.known ? -tip_phi_.value : 0.0;
  const double width = tool_->half_width(), size = std::abs(tip_phi_.value);
  // The depth of a tool that is deep is of interest itself, and so is where the border is passed.
  const double near = kDepthWithin * size;
  const bool below = tip_phi_.value < 0.0;
  tip_free2_ = tip_phi_.known && !(below && size > width) ? size * size : near * near;
  tip_free2_inside_ = tip_phi_.known && !below ? size * size : near * near;
  if (!tip_phi_.known || !below) return;
  passage_.deepest = std::max(passage_.deepest, size);
  if (!passage_.deep && size > width) passage_.deep = {record.time, tip};
}

/// Marches along the way since the row before in steps on which the core cannot meet the surface.
void InsideObserver::march(const Vec3& place, double length, double time) noexcept {
  const Vec3 from = std::exchange(core_, place);
  const Vec3 way = place - from;
  const double least = std::max(kLeastStep * tool_->half_width(), length / kMostStepsOfWay);
  double done = std::min(free_way_, length);
  for (;;) {
    const Vec3 here = length > 0.0 ? Vec3(from + done / length * way) : place;
    const SurfaceDistance phi = solid_->at(here);
    note_core(here, phi, time);
    began_ = true;
    if (done >= length || !std::isfinite(done)) {
      free_way_ = std::abs(phi.value);
      return;
    }
    done = std::min(length, done + std::max(std::abs(phi.value), least));
  }
}

void InsideObserver::note_core(const Vec3& place, const SurfaceDistance& phi, double time) noexcept {
  const double step = kNormalsOver * tool_->half_width();
  const SolidSide before = std::exchange(side_, side_of(phi));
  if (!began_) passage_.began_inside = side_ == SolidSide::inside;
  passage_.ends_inside = side_ == SolidSide::inside;
  if (side_ == SolidSide::inside && before == SolidSide::outside) {
    entry_normal_ = solid_->gradient(outside_, step);
    if (!passage_.left) passage_.entered = place;
  }
  if (side_ == SolidSide::outside && before == SolidSide::inside && entry_normal_ &&
      look_away(*entry_normal_, solid_->gradient(place, step)) && !passage_.left) {
    passage_.left = {time, place};
  }
  if (side_ != SolidSide::inside) entry_normal_.reset();
  if (side_ == SolidSide::outside) outside_ = place;
}

InsideDepths InsideObserver::depths() {
  InsideDepths depths = depths_;
  const double width = tool_->half_width(), error = search_.error();
  depths.max_within = depths.settled_within = InsideSearch::kTolerance * width + error;
  if (every_ > 0) return depths;
  const double rest = find_deepest(depths);
  for (const auto& sample : settled_.all()) {
    if (const auto depth = search_.depth(sample.pose)) depths.settled.push_back(*depth);
  }
  for (const double depth : depths.settled) depths.max = std::max(depths.max, std::optional(depth));
  if (rest > 0.0) depths.max_within = rest - depths.searched_max() + error;
  return depths;
}

/// Branch and bound over the run: its parts are halved where they may be deeper than the deepest row known, those with
/// the largest bound first, down to rows that hardly differ, of which one is searched. Returns how deep a row may be
/// that could not be looked at [m]; 0 where none is deeper than the deepest row within its tolerance.
double InsideObserver::find_deepest(InsideDepths& depths) {
  struct Stretch {
    std::size_t first, end;
    double way, bound;  ///< how far the rows are from the one in the middle, and how deep they are at most [m]
    bool operator<(const Stretch& other) const { return bound < other.bound; }
  };
  const std::vector<PoseSamples::Sample>& parts = deepest_.all();
  if (parts.empty()) return 0.0;
  const double width = tool_->half_width();
  const auto search = [&](const ToolPose& pose, double way) {
    const double tolerance = InsideSearch::kTolerance - way / width;
    depths.max = std::max(depths.max, search_.depth(pose, depths.max.value_or(0.0), tolerance));
  };
  const auto enough = [&] { return depths.searched_max() + InsideSearch::kTolerance * width; };
  search(std::ranges::max_element(parts, {}, &PoseSamples::Sample::key)->pose, 0.0);
  InsideBound bound(*tool_, *solid_);
  const auto bounded = [&](std::size_t first, std::size_t end) {
    const ToolPose& pose = parts[(first + end) / 2].pose;
    Stretch s{first, end, 0.0, 0.0};
    double moved = 0.0, turned = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const PoseSamples::Sample& part = parts[i];
      moved = std::max(moved, part.way + (part.pose.position - pose.position).norm());
      turned = std::max(turned, part.way / tool_->reach() + (part.pose.axis - pose.axis).norm());
      s.way = std::max(s.way, part.way + tool_->moved_at_most(pose, part.pose));
    }
    const bool last = end - first == 1;
    s.bound = last || (moved < kTogether * width && turned < kTogether)
                  ? bound.at(pose, moved, turned, enough(), last && s.way > kAlike * width)
                  : bound.roughly_at(pose, moved, turned);
    return s;
  };
  const std::size_t most_looks = solid_->bytes() > 0 ? kMostLooks : kMostLooksAtForms;
  std::priority_queue<Stretch> open;
  open.push(bounded(0, parts.size()));
  double rest = 0.0;  // the largest bound of parts that can neither be halved nor searched
  while (!open.empty() && open.top().bound > enough() && bound.looks() + search_.looks() < most_looks) {
    const Stretch s = open.top();
    open.pop();
    const std::size_t middle = (s.first + s.end) / 2;
    if (s.way <= kAlike * width) {
      search(parts[middle].pose, s.way);
    } else if (s.end - s.first == 1) {
      rest = std::max(rest, s.bound);
    } else {
      open.push(bounded(s.first, middle));
      open.push(bounded(middle, s.end));
    }
  }
  if (!open.empty()) rest = std::max(rest, open.top().bound);
  return rest > enough() ? rest : 0.0;
}

}  // namespace hapbench
