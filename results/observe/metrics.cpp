#include "results/observe/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

namespace hapbench {

std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f) {
  if ((mu_s == 0.0 && mu_f == 0.0) || std::isinf(integrator.damper_limit)) return std::nullopt;
  const double largest = integrator.damper_limit * mass / dt;
  if (mu_s >= largest) return 0.0;
  return mu_f > 0.0 ? std::optional((largest - mu_s) / mu_f) : std::nullopt;
}

namespace {

/// Sets `sorted` to the numbers in ascending order. Allocates nothing if they fit into its capacity.
void sort_into(std::vector<std::uint32_t>& sorted, std::span<const std::uint32_t> numbers) noexcept {
  assert(numbers.size() <= sorted.capacity());
  sorted.assign(numbers.begin(), numbers.end());
  if (!std::ranges::is_sorted(sorted)) std::ranges::sort(sorted);  // usually ascending, unless the points were shuffled
}

}  // namespace

ReductionJumps::ReductionJumps(std::size_t capacity) {
  for (std::vector<std::uint32_t>* numbers : {&last_, &sorted_last_, &sorted_now_}) numbers->reserve(capacity);
}

void ReductionJumps::add(const ContactBuffer& kept, double step_squared, bool settled) noexcept {
  const std::span<const std::uint32_t> now(kept.index.data(), kept.size());
  // Return early in most steps: the kept points and their order have not changed.
  if (std::ranges::equal(now, last_)) return;

  // Compare the sets of points.
  bool same = false;
  if (now.size() == last_.size()) {
    sort_into(sorted_now_, now);
    sort_into(sorted_last_, last_);
    same = sorted_now_ == sorted_last_;
  }

  const bool changed = !same && !now.empty() && !last_.empty();
  if (changed) ++changes_;
  if (settled && changed) step_max_squared_ = std::max(step_max_squared_.value_or(0.0), step_squared);
  assert(now.size() <= last_.capacity());
  last_.assign(now.begin(), now.end());
}

MetricsObserver::MetricsObserver(double dt, const MetricsConfig& config)
    : stride_(config.stride),
      first_(config.first),
      vibration_(dt),
      last_quarter_(config.steps, dt),
      friction_limit_(config.friction_limit),
      contact_forces_(dt, config.settling) {
  assert(dt > 0.0 && first_ < stride_);
  if (config.reduction_capacity) reduction_.emplace(*config.reduction_capacity);
}

void MetricsObserver::begin() noexcept {
  if (trials_++ > 0) hashes_before_.word(hash_.value());
  hash_ = {};
  before_ = before_ + std::exchange(now_, {});
  settled_ = false;
  last_force_ = Vec3::Zero();
  last_quarter_.begin();
  contact_forces_.begin();
  if (reduction_) reduction_->begin();
}

void MetricsObserver::on_step(const StepRecord& record) noexcept {
  if (stride_ > 1 && record.step % stride_ != first_) return;
  add_motion(record.tool.pose.position, record.body_velocity());
  last_quarter_.add(now_.rows, record.handle.velocity);
  add_contacts(record, add_force(record.force));
  ++now_.rows;

  for (const Vec3* v : {&record.tool.pose.position, &record.tool.velocity, &record.force.rendered})
    for (const double coordinate : *v) hash_.real(coordinate);
}

void MetricsObserver::add_motion(const Vec3& position, const Vec3& v) noexcept {
  if (now_.rows > 0) velocity_variation_ += (v - last_velocity_).norm();
  vibration_.add(now_.rows, v);
  speed_max_squared_ = std::max(speed_max_squared_, v.squaredNorm());
  position_ = position;
  last_velocity_ = v;
}

ForceChange MetricsObserver::add_force(const RenderedForce& force) noexcept {
  // The force before the first step counts as zero, so the first step reverses nothing.
  ForceChange change;
  change.reverses = force.rendered.dot(last_force_) < 0.0;
  if (change.reverses) ++force_reversals_;
  now_.force_max_squared = std::max(now_.force_max_squared, force.rendered.squaredNorm());
  if (now_.rows > 0) change.squared = (force.rendered - last_force_).squaredNorm();
  force_step_max_squared_ = std::max(force_step_max_squared_, change.squared);
  depth_max_ = std::max(depth_max_, force.depth_max);
  if (friction_limit_ && force.spring.squaredNorm() > *friction_limit_ * *friction_limit_) {
    if (rows_beyond_friction_++ == 0) first_beyond_friction_ = now_.rows;
  }
  last_force_ = force.rendered;
  return change;
}

void MetricsObserver::add_contacts(const StepRecord& record, const ForceChange& change) noexcept {
  const auto phase = contact_forces_.add(record.force.rendered, change, record.colliding > 0);
  settled_ = phase == ContactForces::Phase::settled;
  if (reduction_) reduction_->add(*record.rendered, change.squared, settled_);
  const std::uint64_t rendered = record.rendered->size();
  colliding_sum_ += record.colliding;
  rendered_sum_ += rendered;
  colliding_max_ = std::max<std::uint64_t>(colliding_max_, record.colliding);
  rendered_max_ = std::max(rendered_max_, rendered);
  if (record.colliding > 0) {
    ++now_.in_contact;
    now_.last = record.time;
  }
  if (rendered == 0) return;
  ratio_.min = std::min(ratio_.min, record.ratio.min);
  ratio_.max = std::max(ratio_.max, record.ratio.max);
}

std::uint64_t MetricsObserver::state_hash() const noexcept {
  if (trials_ <= 1) return hash_.value();
  Hash64 hashes = hashes_before_;
  hashes.word(hash_.value());
  return hashes.value();
}

void MetricsObserver::report(Section& s) const {
  report_motion_and_force(s);
  report_contacts(s);
  s.metric("speed_max_m_per_s", "m/s", "largest ||v|| of the moving body, as velocity_total_variation_m_per_s",
           std::sqrt(speed_max_squared_));
  s.metric(
      "explicit_friction_limit_N", "N",
      "largest ||f_spring|| at which the explicit integrator is stable with friction, (B_max - mu_s) / mu_f with the "
      "friction coefficients mu_s [N s/m] and mu_f [s/m], and B_max = 2 M / dt of leapfrog, 4 M / dt of "
      "velocity_verlet; no value if the run has no such limit",
      friction_limit_);
  s.metric("explicit_friction_rows_beyond", "1",
           "number of steps with ||f_spring|| (fspring_x_N, fspring_y_N, fspring_z_N of trajectory.csv) above "
           "explicit_friction_limit_N; no value without this limit",
           if_any(friction_limit_.has_value(), rows_beyond_friction_), Better::less);
  s.metric(
      "explicit_friction_first_step", "1",
      "number of the first step with ||f_spring|| above explicit_friction_limit_N; no value if no step is above it",
      first_beyond_friction_);
  contact_forces_.report(s);
  s.metric(
      "reduction_changes", "1",
      "number of steps whose set of points kept by rendering.reduction (index of contacts.csv) differs from the set of "
      "the previous step, both steps being in contact; no value without rendering.reduction",
      reduction_ ? std::optional(reduction_->changes()) : std::nullopt, Better::less);
  s.metric("reduction_force_step_max_N", "N",
           "largest force step ||f_k - f_(k-1)|| over the steps in settled contact at which the set of points kept by "
           "rendering.reduction changes; no value without rendering.reduction",
           reduction_ ? reduction_->step_max() : std::nullopt, Better::less);
}

void MetricsObserver::report_motion_and_force(Section& s) const {
  s.metric("force_max_N", "N",
           "largest norm of the rendered force over the run, max ||f|| with f = (fx_N, fy_N, fz_N) of trajectory.csv, "
           "landings included",
           std::sqrt((before_ + now_).force_max_squared), Better::less);
  s.metric(
      "force_step_max_N", "N",
      "largest force step ||f_k - f_(k-1)|| from one time step to the next, f = (fx_N, fy_N, fz_N) of trajectory.csv, "
      "landings included",
      std::sqrt(force_step_max_squared_), Better::less);
  s.metric(
       "velocity_total_variation_m_per_s", "m/s",
       "total variation of the velocity of the moving body: sum of ||v_k - v_(k-1)|| over all steps, with v = "
       "(hvx_m_per_s, hvy_m_per_s, hvz_m_per_s) of trajectory.csv if the handle of an impedance device moves the tool, "
       "otherwise (vx_m_per_s, vy_m_per_s, vz_m_per_s); a smooth motion has a small value",
       velocity_variation_, Better::less)
      .varies_smoothly();
  s.metric(
      "force_reversals", "1",
      "number of reversals: steps whose force has a negative inner product with the force of the previous step, f_k . "
      "f_(k-1) < 0, f = (fx_N, fy_N, fz_N) of trajectory.csv",
      force_reversals_, Better::less);
  s.metric("vibration_power_above_30Hz_m2_per_s2", "m2/s2",
           "mean ||v||^2 of the velocity of the moving body (as velocity_total_variation_m_per_s) after the 30 Hz "
           "high-pass, in steady state at the first step, over all steps; the high-pass is a Butterworth filter of "
           "fourth order, made by the bilinear transform with prewarped cutoff, for each component; no value at "
           "sampling rates of 60 Hz or less",
           vibration_.mean_square(), Better::less)
      .varies_smoothly();
  s.metric("depth_max_m", "m",
           "largest penetration depth of a colliding point (depth_max_m of trajectory.csv), by the depth model; with "
           "shortest_distance and surface_normal at most the tool's half width, even if the tool is deeper in the "
           "environment (inside_max_m)",
           depth_max_, Better::less);
}

void MetricsObserver::report_contacts(Section& s) const {
  const TrialContact all = before_ + now_;
  s.metric("ratio_min", "1",
           "smallest stiffness ratio rho = u^T S u over all rendered contacts (ratio_min of trajectory.csv): combined "
           "stiffness along the contact's "
           "gradient u, in units of K; no value without contact",
           ratio_.min);
  s.metric("ratio_max", "1",
           "largest stiffness ratio rho = u^T S u over all rendered contacts (ratio_max of trajectory.csv): combined "
           "stiffness along the contact's "
           "gradient u, in units of K; no value without contact",
           ratio_.max);
  s.metric("colliding_mean", "1",
           "mean number of colliding points per step (colliding of trajectory.csv), including steps without contact",
           per(colliding_sum_, rows()));
  s.metric("colliding_max", "1", "largest number of colliding points in one step (colliding of trajectory.csv)",
           colliding_max_);
  s.metric("rendered_mean", "1",
           "mean number of rendered points (rendered of trajectory.csv: colliding points after local average and "
           "reduction, which the force law "
           "receives) per step, including steps without contact",
           per(rendered_sum_, rows()));
  s.metric("rendered_max", "1", "largest number of rendered points (rendered of trajectory.csv) in one step",
           rendered_max_);
  s.metric("steps_in_contact", "1",
           "number of steps with at least one colliding point (colliding of trajectory.csv > 0)", all.in_contact);
  s.metric("contact_share", "1", "fraction of the run in contact: steps_in_contact / steps",
           per(all.in_contact, rows()));
  s.metric("last_contact_s", "s", "time_s of the last step with a colliding point; no value without contact", all.last);
}

void MetricsObserver::report_end(Section& s) const {
  s.metric(
       "vibration_last_quarter_m_per_s", "m/s",
       "vibration of the handle: root mean square of its velocity (hvx_m_per_s, hvy_m_per_s, hvz_m_per_s of "
       "trajectory.csv) after the 30 Hz high-pass, in steady state at the first step, over the last quarter of the "
       "run; `limit --stable still` judges the same velocity, but from the first quarter of the contact time on; no "
       "value at sampling rates of 60 Hz or less",
       last_quarter_.value(), Better::less)
      .varies_smoothly();
  const bool any = rows() > 0;
  s.metric("final_position_m.x", "m", "x of the tip's centre at the last step (px_m of trajectory.csv)",
           if_any(any, position_.x()))
      .varies_smoothly()
      .has_either_sign();
  s.metric("final_position_m.y", "m", "y of the tip's centre at the last step (py_m of trajectory.csv)",
           if_any(any, position_.y()))
      .varies_smoothly()
      .has_either_sign();
  s.metric("final_position_m.z", "m", "z of the tip's centre at the last step (pz_m of trajectory.csv)",
           if_any(any, position_.z()))
      .varies_smoothly()
      .has_either_sign();
}

}  // namespace hapbench
