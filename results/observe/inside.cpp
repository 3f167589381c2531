#include "results/observe/inside.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "results/observe/metrics.hpp"

namespace hapbench {
namespace {

/// Relative to the tool's half width: the least step in which the core's way is looked at, and over which normals are
/// measured; relative to the depth: what a depth of the tip centre may be wrong by.
constexpr double kLeastStep = 2e-3, kDifference = 1e-3, kDepthWithin = 0.02;
constexpr double kMostLooks = 256.0;  ///< at the core's way in a row
/// Rows whose deepest point is looked for after a run, and how well (InsideSearch): a few per cent of a run of seconds.
constexpr std::size_t kDeepest = 6, kSettled = 12;
constexpr double kTolerance = 0.2;

/// Distance from the tip centre back to the place half a width within the body.
double way_to_core(const ToolShape& tool) {
  ContactBuffer tip(1);
  tip.push(0, Vec3::Zero(), Vec3::UnitZ());
  tool.surface_constraints(ToolPose{}, Vec3::Zero(), 0.0, tip);
  return std::clamp(tool.half_width() - tip.depth[0], 0.0, tool.half_width());
}

}  // namespace

InsideMetrics& InsideMetrics::operator+=(const InsideMetrics& other) {
  max = std::max(max, other.max);  // an empty optional is less than any number
  settled.insert(settled.end(), other.settled.begin(), other.settled.end());
  rows += other.rows;
  centre_inside += other.centre_inside;
  return *this;
}

std::optional<double> InsideMetrics::settled_median() const {
  if (settled.empty()) return std::nullopt;
  std::vector<double> sorted = settled;
  std::sort(sorted.begin(), sorted.end());
  return 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
}

void PoseSamples::add(const ToolPose& pose, double key) noexcept {
  if (rows_++ % rows_of_part_ != 0) {
    if (key > samples_.back().key) samples_.back() = {pose, key};
    return;
  }
  if (samples_.size() == most_) {
    for (std::size_t i = 0; i < most_ / 2; ++i) {
      const Sample &a = samples_[2 * i], &b = samples_[2 * i + 1];
      samples_[i] = b.key > a.key ? b : a;
    }
    samples_.resize(most_ / 2);
    rows_of_part_ *= 2;
  }
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
      deepest_(2 * kDeepest),
      settled_(kSettled) {
  if (every_ > 0) metrics_.settled.reserve(steps / every_ + 1);
}

void InsideObserver::on_step(const StepRecord& record) noexcept {
  const ToolPose& pose = record.tool.pose;
  follow_tip(record);
  follow_core(pose.position - back_ * pose.axis, record.time);
  began_ = true;
  const bool settled = settled_by_ != nullptr && settled_by_->in_settled_contact();
  depth_.reset();
  if (every_ > 0) {
    if (record.step % every_ != 0) return;
    depth_ = search_.depth(pose);
    if (!depth_) return;
    metrics_.max = std::max(metrics_.max, depth_);
    if (settled) metrics_.settled.push_back(*depth_);
    return;
  }
  // The depth of contacts tells until the core is inside, and from there on that of the tip centre.
  const bool deep = side_ == Side::inside;
  deepest_.add(pose, deep ? tool_->half_width() + std::max(0.0, -tip_phi_.value) : record.force.depth_max);
  if (settled) settled_.add(pose, 0.0);
}

void InsideObserver::follow_tip(const StepRecord& record) noexcept {
  const Vec3& tip = record.tool.pose.position;
  const double width = tool_->half_width(), size = std::abs(tip_phi_.value);
  // The depth of a tool that is deep is of interest itself, and so is where the border is passed.
  const bool deep = tip_phi_.value < 0.0 && (size > width || side_ == Side::inside);
  const double free = !tip_phi_.known || deep ? kDepthWithin * size : size;
  if (!began_ || !((tip - tip_looked_).squaredNorm() < free * free)) {
    tip_phi_ = solid_->at(tip);
    tip_looked_ = tip;
  }
  passage_.last_depth = tip_phi_.known ? -tip_phi_.value : 0.0;
  if (!tip_phi_.known) return;
  ++metrics_.rows;
  if (tip_phi_.value >= 0.0) return;
  ++metrics_.centre_inside;
  passage_.deepest = std::max(passage_.deepest, -tip_phi_.value);
  if (!passage_.deep && -tip_phi_.value > width) passage_.deep = {record.time, tip};
}

/// Marches along the way since the row before in steps on which the core cannot meet the surface.
void InsideObserver::follow_core(const Vec3& place, double time) noexcept {
  const Vec3 from = std::exchange(core_, place);
  const Vec3 way = place - from;
  const double length = began_ ? way.norm() : 0.0;
  if (began_ && free_way_ > length) {
    free_way_ -= length;
    return;
  }
  const double least = std::max(kLeastStep * tool_->half_width(), length / kMostLooks);
  double done = began_ ? std::min(free_way_, length) : 0.0;
  for (;;) {
    const Vec3 here = length > 0.0 ? Vec3(from + done / length * way) : place;
    const SurfaceDistance phi = solid_->at(here);
    note_core(here, phi, time);
    if (done >= length || !std::isfinite(done)) {
      free_way_ = std::abs(phi.value);
      return;
    }
    done = std::min(length, done + std::max(std::abs(phi.value), least));
  }
}

void InsideObserver::note_core(const Vec3& place, const SurfaceDistance& phi, double time) noexcept {
  const double step = kDifference * tool_->half_width();
  const Side before = std::exchange(side_, !phi.known ? Side::unknown : phi.value < 0.0 ? Side::inside : Side::outside);
  if (!began_) passage_.began_inside = side_ == Side::inside;
  passage_.ends_inside = side_ == Side::inside;
  if (side_ == Side::inside && before == Side::outside) {
    entry_normal_ = solid_->gradient(outside_, step);
    if (!passage_.left) passage_.entered = place;
  }
  if (side_ == Side::outside && before == Side::inside && entry_normal_ &&
      entry_normal_->dot(solid_->gradient(place, step)) < 0.0 && !passage_.left) {
    passage_.left = {time, place};
  }
  if (side_ != Side::inside) entry_normal_.reset();
  if (side_ == Side::outside) outside_ = place;
}

InsideMetrics InsideObserver::metrics() {
  InsideMetrics metrics = metrics_;
  if (every_ > 0) return metrics;
  std::vector<PoseSamples::Sample> deepest = deepest_.all();
  std::stable_sort(deepest.begin(), deepest.end(), [](const auto& a, const auto& b) { return a.key > b.key; });
  deepest.resize(std::min(deepest.size(), kDeepest));
  for (const auto& sample : deepest)
    metrics.max = std::max(metrics.max, search_.depth(sample.pose, metrics.max.value_or(0.0), kTolerance));
  for (const auto& sample : settled_.all()) {
    if (const auto depth = search_.depth(sample.pose, 0.0, kTolerance)) metrics.settled.push_back(*depth);
  }
  for (const double depth : metrics.settled) metrics.max = std::max(metrics.max, std::optional(depth));
  return metrics;
}

}  // namespace hapbench
