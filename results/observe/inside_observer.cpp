#include "results/observe/inside_observer.hpp"

#include <algorithm>
#include <cmath>
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

}  // namespace

void InsideDepths::add(const InsideDepths& trial) {
  const auto bound = [](const InsideDepths& m) {
    return (1.0 + InsideSearch::kTolerance) * m.max.value_or(0.0) + m.max_within;
  };
  const double deepest = std::max(bound(*this), bound(trial));
  max = std::max(max, trial.max);  // an empty optional is less than any number
  max_within = deepest - (1.0 + InsideSearch::kTolerance) * max.value_or(0.0);
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
       "largest distance below the environment's surface of any point of the tool in any row, with record.inside "
       "in any recorded row; no row is deeper by more than 2 % of it and of the tool's half width, or its tolerance "
       "tells by how much; none of springs and beyond the border of an open surface",
       max, Better::less)
      .within(InsideSearch::kTolerance, max_within);
  s.metric("inside_settled_m", "m",
           "median of that distance over up to twelve rows in settled contact, evenly spread, or with record.inside "
           "over all recorded ones",
           has_settled ? settled_median() : std::nullopt, Better::less)
      .within(InsideSearch::kTolerance, settled_within);
  s.metric("centre_inside_share", "1",
           "share of the rows with the tip centre below the surface; a flat tip's is when it is pressed in",
           if_any(rows > 0, static_cast<double>(centre_inside) / static_cast<double>(rows)), Better::less);
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
      core_passage_(tool_, solid_),
      deepest_(kParts, *tool_),
      settled_(kSettled, *tool_) {
  if (every_ > 0) depths_.settled.reserve(steps / every_ + 1);
}

void InsideObserver::on_step(const StepRecord& record) noexcept {
  const ToolPose& pose = record.tool.pose;
  const double free2 = side_ == Side::inside ? tip_free2_inside_ : tip_free2_;
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
  if (every_ > 0) return search_row(record, settled);
  // The depth of contacts tells until the core is inside, and from there on that of the tip centre.
  const bool deep = side_ == Side::inside;
  deepest_.add(pose, deep ? tool_->half_width() + std::max(0.0, -tip_phi_.value) : record.force.depth_max);
  if (settled) settled_.add(pose, 0.0);
}

void InsideObserver::search_row(const StepRecord& record, bool settled) noexcept {
  depth_.reset();
  if (record.step % every_ == 0) depth_ = search_.depth(record.tool.pose);
  if (!depth_) return;
  depths_.max = std::max(depths_.max, depth_);
  if (settled) depths_.settled.push_back(*depth_);
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
  const Side before = std::exchange(side_, !phi.known ? Side::unknown : phi.value < 0.0 ? Side::inside : Side::outside);
  if (!began_) passage_.began_inside = side_ == Side::inside;
  passage_.ends_inside = side_ == Side::inside;
  if (side_ == Side::inside && before == Side::outside) {
    entry_normal_ = solid_->gradient(outside_, step);
    if (!passage_.left) passage_.entered = place;
  }
  if (side_ == Side::outside && before == Side::inside && entry_normal_ &&
      look_away(*entry_normal_, solid_->gradient(place, step)) && !passage_.left) {
    passage_.left = {time, place};
  }
  if (side_ != Side::inside) entry_normal_.reset();
  if (side_ == Side::outside) outside_ = place;
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
  if (rest > 0.0) depths.max_within = rest - (1.0 + InsideSearch::kTolerance) * depths.max.value_or(0.0) + error;
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
  const auto enough = [&] {
    return (1.0 + InsideSearch::kTolerance) * depths.max.value_or(0.0) + InsideSearch::kTolerance * width;
  };
  search(std::max_element(parts.begin(), parts.end(), [](auto& a, auto& b) { return a.key < b.key; })->pose, 0.0);
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
