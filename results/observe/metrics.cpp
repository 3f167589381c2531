#include "results/observe/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "sim/loop/integrators/table.hpp"

namespace hapbench {

std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f) {
  if ((mu_s == 0.0 && mu_f == 0.0) || std::isinf(integrator.damper_limit)) return std::nullopt;
  const double largest = integrator.damper_limit * mass / dt;
  if (mu_s >= largest) return 0.0;
  return mu_f > 0.0 ? std::optional((largest - mu_s) / mu_f) : std::nullopt;
}

namespace {

constexpr double kFarMore = 3.0;

}  // namespace

ReductionJumps& ReductionJumps::operator+=(const ReductionJumps& other) noexcept {
  changes += other.changes;
  step_max_squared = std::max(step_max_squared, other.step_max_squared);  // an empty optional is less than any number
  step_max_squared_elsewhere = std::max(step_max_squared_elsewhere, other.step_max_squared_elsewhere);
  return *this;
}

std::optional<double> ReductionJumps::step_max() const noexcept {
  return step_max_squared ? std::optional(std::sqrt(*step_max_squared)) : std::nullopt;
}

double ReductionJumps::step_max_elsewhere() const noexcept {
  return std::sqrt(step_max_squared_elsewhere);
}

bool ReductionJumps::stand_out() const noexcept {
  return step_max().value_or(0.0) > kFarMore * step_max_elsewhere();
}

void ReductionJumpObserver::add(const ContactBuffer& kept, double step_squared, bool settled) noexcept {
  const std::span now(kept.index.data(), kept.size());
  const bool same = std::is_permutation(now.begin(), now.end(), last_.begin(), last_.end());
  const bool changed = !same && !now.empty() && !last_.empty();
  if (changed) ++jumps_.changes;
  if (settled && changed) jumps_.step_max_squared = std::max(jumps_.step_max_squared.value_or(0.0), step_squared);
  if (settled && !changed && !changed_) {
    jumps_.step_max_squared_elsewhere = std::max(jumps_.step_max_squared_elsewhere, step_squared);
  }
  changed_ = changed;
  assert(now.size() <= last_.capacity());
  if (!same) last_.assign(now.begin(), now.end());
}

namespace {

void add(Hash64& hash, const Vec3& v) noexcept {
  hash.real(v.x());
  hash.real(v.y());
  hash.real(v.z());
}

}  // namespace

MetricsObserver::MetricsObserver(double dt, const MetricsConfig& config)
    : last_quarter_(config.steps, dt), contact_forces_(dt, config.settling) {
  assert(dt > 0.0);
  if (config.friction_limit) {
    metrics_.explicit_friction = ExplicitFriction{*config.friction_limit, 0, {}};
    friction_limit_squared_ = *config.friction_limit * *config.friction_limit;
  }
  if (config.most_reduced) reduction_.emplace(*config.most_reduced);
  high_pass_ = vibration_filter(dt);
}

void MetricsObserver::on_step(const StepRecord& record) noexcept {
  add_motion(record.tool.pose.position, record.body_velocity());
  last_quarter_.add(record.step, record.handle.velocity);
  add_contacts(record, add_force(record.force));
  ++metrics_.rows;

  add(hash_, record.tool.pose.position);
  add(hash_, record.tool.velocity);
  add(hash_, record.force.rendered);
}

void MetricsObserver::add_motion(const Vec3& position, const Vec3& v) noexcept {
  const bool first = metrics_.rows == 0;
  if (!first) metrics_.velocity_total_variation += (v - last_velocity_).norm();
  if (high_pass_) {
    if (first) high_pass_->settle_at(v);
    vibration_sum_ += high_pass_->filter(v).squaredNorm();
  }
  speed_max_squared_ = std::max(speed_max_squared_, v.squaredNorm());
  metrics_.final_position = position;
  last_velocity_ = v;
}

ForceChange MetricsObserver::add_force(const RenderedForce& force) noexcept {
  // The initial last force is zero, so the first row reverses nothing.
  ForceChange change;
  change.reverses = force.rendered.dot(last_force_) < 0.0;
  if (change.reverses) ++metrics_.force_reversals;
  force_max_squared_ = std::max(force_max_squared_, force.rendered.squaredNorm());
  if (metrics_.rows > 0) change.squared = (force.rendered - last_force_).squaredNorm();
  force_step_max_squared_ = std::max(force_step_max_squared_, change.squared);
  metrics_.depth_max = std::max(metrics_.depth_max, force.depth_max);
  if (force.spring.squaredNorm() > friction_limit_squared_) {
    ExplicitFriction& friction = *metrics_.explicit_friction;
    if (!friction.first_step) friction.first_step = metrics_.rows;
    ++friction.rows_beyond;
  }
  last_force_ = force.rendered;
  return change;
}

void MetricsObserver::add_contacts(const StepRecord& record, const ForceChange& change) noexcept {
  const auto phase = contact_forces_.add(record.force.rendered, change, record.colliding > 0);
  settled_ = phase == ContactForceObserver::Phase::settled;
  if (reduction_) reduction_->add(*record.rendered, change.squared, settled_);
  const std::uint64_t rendered = record.rendered->size();
  colliding_sum_ += record.colliding;
  rendered_sum_ += rendered;
  metrics_.colliding_max = std::max<std::uint64_t>(metrics_.colliding_max, record.colliding);
  metrics_.rendered_max = std::max(metrics_.rendered_max, rendered);
  if (record.colliding > 0) {
    ++metrics_.steps_in_contact;
    metrics_.last_contact = record.time;
  }
  if (rendered == 0) return;
  if (!metrics_.ratio) metrics_.ratio = record.ratio;
  metrics_.ratio->min = std::min(metrics_.ratio->min, record.ratio.min);
  metrics_.ratio->max = std::max(metrics_.ratio->max, record.ratio.max);
}

Metrics MetricsObserver::metrics() const noexcept {
  Metrics m = metrics_;
  m.force_max = std::sqrt(force_max_squared_);
  m.force_step_max = std::sqrt(force_step_max_squared_);
  m.speed_max = std::sqrt(speed_max_squared_);
  m.state_hash = hash_.value();
  m.last_quarter_vibration = last_quarter_.value();
  m.contact = contact_forces_.forces();
  if (reduction_) m.reduction = reduction_->jumps();
  if (m.rows == 0) return m;

  const auto rows = static_cast<double>(m.rows);
  if (high_pass_) m.vibration_power = vibration_sum_ / rows;
  m.colliding_mean = static_cast<double>(colliding_sum_) / rows;
  m.rendered_mean = static_cast<double>(rendered_sum_) / rows;
  return m;
}

Metrics merged(const std::vector<Metrics>& runs) noexcept {
  if (runs.size() == 1) return runs.front();
  Metrics all;
  Hash64 hash;
  double vibration = 0.0, colliding = 0.0, rendered = 0.0;
  bool has_vibration = true;
  all.contact = runs.front().contact;
  for (std::size_t i = 1; i < runs.size(); ++i) all.contact += runs[i].contact;
  for (const Metrics& run : runs) {
    const auto rows = static_cast<double>(run.rows);
    all.rows += run.rows;
    all.force_max = std::max(all.force_max, run.force_max);
    all.force_step_max = std::max(all.force_step_max, run.force_step_max);
    all.velocity_total_variation += run.velocity_total_variation;
    all.force_reversals += run.force_reversals;
    has_vibration = has_vibration && run.vibration_power;
    vibration += rows * run.vibration_power.value_or(0.0);
    all.last_quarter_vibration = std::max(all.last_quarter_vibration, run.last_quarter_vibration);
    all.depth_max = std::max(all.depth_max, run.depth_max);
    if (run.ratio && !all.ratio) all.ratio = run.ratio;
    if (run.ratio) {
      all.ratio = RatioRange{std::min(all.ratio->min, run.ratio->min), std::max(all.ratio->max, run.ratio->max)};
    }
    colliding += rows * run.colliding_mean;
    rendered += rows * run.rendered_mean;
    all.colliding_max = std::max(all.colliding_max, run.colliding_max);
    all.rendered_max = std::max(all.rendered_max, run.rendered_max);
    all.steps_in_contact += run.steps_in_contact;
    if (run.last_contact) all.last_contact = std::max(*run.last_contact, all.last_contact.value_or(0.0));
    all.speed_max = std::max(all.speed_max, run.speed_max);
    if (run.explicit_friction) {
      if (!all.explicit_friction) all.explicit_friction = ExplicitFriction{run.explicit_friction->limit, 0, {}};
      ExplicitFriction& friction = *all.explicit_friction;
      friction.rows_beyond += run.explicit_friction->rows_beyond;
      if (!friction.first_step) friction.first_step = run.explicit_friction->first_step;
    }
    if (all.reduction && run.reduction) *all.reduction += *run.reduction;
    if (!all.reduction) all.reduction = run.reduction;
    if (all.inside && run.inside) *all.inside += *run.inside;
    if (!all.inside) all.inside = run.inside;
    all.final_position = run.final_position;
    hash.word(run.state_hash);
  }
  const auto rows = static_cast<double>(all.rows);
  if (has_vibration && all.rows > 0) all.vibration_power = vibration / rows;
  if (all.rows > 0) {
    all.colliding_mean = colliding / rows;
    all.rendered_mean = rendered / rows;
  }
  all.state_hash = hash.value();
  return all;
}

namespace {

MetricList reduction_list(const std::optional<ReductionJumps>& given) {
  const ReductionJumps jumps = given.value_or(ReductionJumps{});
  return {{"reduction_changes", "1",
           "rows in contact whose set of kept points is another than in the row before, in contact too; with "
           "rendering.reduction",
           if_any(given.has_value(), jumps.changes), Better::less},
          {"reduction_force_step_max_N", "N",
           "largest force step ||f_k - f_(k-1)|| of such rows in settled contact; with rendering.reduction",
           jumps.step_max(), Better::less}};
}

MetricList inside_list(const Metrics& m) {
  const InsideMetrics inside = m.inside.value_or(InsideMetrics{});
  const auto rows = static_cast<double>(inside.rows);
  return {
      Metric("inside_max_m", "m",
             "largest distance below the environment's surface of any point of the tool in any row, with record.inside "
             "in any recorded row; no row is deeper by more than 2 % of it and of the tool's half width, or a warning "
             "tells by how much; none of springs and beyond the border of an open surface",
             inside.max, Better::less)
          .within(InsideSearch::kTolerance, inside.max_within),
      Metric("inside_settled_m", "m",
             "median of that distance over up to twelve rows in settled contact, evenly spread, or with record.inside "
             "over all recorded ones",
             if_any(m.contact.settled >= kLeastSettled, inside.settled_median()).value_or(std::nullopt), Better::less)
          .within(InsideSearch::kTolerance, inside.settled_within),
      {"centre_inside_share", "1",
       "share of the rows with the tip centre below the surface; a flat tip's is when it is pressed in",
       if_any(inside.rows > 0, static_cast<double>(inside.centre_inside) / rows), Better::less},
      {"vibration_last_quarter_m_per_s", "m/s",
       "root mean square of the handle's speed above 30 Hz in the last quarter of the run, by which limit "
       "--stable still judges it; none at sampling rates of 60 Hz or less",
       m.last_quarter_vibration, Better::less}};
}

}  // namespace

MetricList metric_list(const Metrics& m) {
  const bool any = m.rows > 0;
  const auto ratio = m.ratio.value_or(RatioRange{});
  const auto friction = m.explicit_friction.value_or(ExplicitFriction{});
  MetricList list = {
      {"force_max_N", "N", "largest ||f|| of a row", m.force_max, Better::less},
      {"force_step_max_N", "N", "largest force step ||f_k - f_(k-1)||, landings included", m.force_step_max,
       Better::less},
      {"velocity_total_variation_m_per_s", "m/s",
       "sum ||v_k - v_(k-1)|| over all rows: what a smooth motion has little of", m.velocity_total_variation,
       Better::less},
      {"force_reversals", "1", "rows whose f has a negative inner product with that of the row before",
       m.force_reversals, Better::less},
      {"vibration_power_above_30Hz_m2_per_s2", "m2/s2",
       "mean ||v||^2 of all rows behind a high-pass (Butterworth, fourth order, 30 Hz); none at sampling rates of "
       "60 Hz or less",
       m.vibration_power, Better::less},
      {"depth_max_m", "m",
       "largest penetration depth of a colliding point: at most the tool's half width, however deep the tool is",
       m.depth_max, Better::less},
      {"ratio_min", "1",
       "smallest stiffness ratio rho = u^T S u of a rendered contact: the combined stiffness along it, in units of K",
       if_any(m.ratio.has_value(), ratio.min)},
      {"ratio_max", "1", "largest such ratio", if_any(m.ratio.has_value(), ratio.max)},
      {"colliding_mean", "1", "colliding points per row, rows without contact included", if_any(any, m.colliding_mean)},
      {"colliding_max", "1", "most colliding points of a row", m.colliding_max},
      {"rendered_mean", "1",
       "points that the force law saw (after local average and reduction) per row, rows without contact included",
       if_any(any, m.rendered_mean)},
      {"rendered_max", "1", "most points that the force law saw in a row", m.rendered_max},
      {"steps_in_contact", "1", "rows with a colliding point", m.steps_in_contact},
      {"contact_share", "1", "steps_in_contact / steps",
       if_any(any, static_cast<double>(m.steps_in_contact) / static_cast<double>(m.rows))},
      {"last_contact_s", "s", "time of the last row with a colliding point", m.last_contact},
      {"speed_max_m_per_s", "m/s", "largest speed of the tip's centre", m.speed_max},
      {"explicit_friction_limit_N", "N",
       "largest ||f_spring|| whose friction the explicit integrator steps stably, (B_max - mu_s) / mu_f",
       if_any(m.explicit_friction.has_value(), friction.limit)},
      {"explicit_friction_rows_beyond", "1", "rows with a larger ||f_spring||",
       if_any(m.explicit_friction.has_value(), friction.rows_beyond), Better::less},
      {"explicit_friction_first_step", "1", "the first of those rows", friction.first_step}};
  append(list, "", metric_list(m.contact));
  append(list, "", reduction_list(m.reduction));
  append(list, "", inside_list(m));
  return list;
}

MetricList final_position_list(const Metrics& m) {
  const bool any = m.rows > 0;
  return {{"final_position_m.x", "m", "x of the tip's centre in the last row", if_any(any, m.final_position.x())},
          {"final_position_m.y", "m", "y of the tip's centre in the last row", if_any(any, m.final_position.y())},
          {"final_position_m.z", "m", "z of the tip's centre in the last row", if_any(any, m.final_position.z())}};
}

}  // namespace hapbench
