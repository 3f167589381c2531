#include "results/observe/contact_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "sim/loop/simulation.hpp"

namespace hapbench {
namespace {

constexpr std::uint64_t kMostAges = 1'000'000;

}  // namespace

void ContactAgeObserver::begin(const TrialParts& trial) {
  *this = {};
  contacts_ = &dynamic_cast<const LateContacts&>(*trial.simulation.source);
  dt_ = trial.config.dt;
  rows_of_age_.resize(std::min(trial.config.steps, kMostAges) + 1);
}

void ContactAgeObserver::on_step(const StepRecord& record) noexcept {
  asked_ = contacts_->asked();
  lost_ = contacts_->lost();
  const LateContacts::Query* query = contacts_->used();
  if (query == nullptr) return;
  const std::uint64_t age = record.step - query->row;
  ++rows_;
  oldest_ = std::max(oldest_, age);
  ++rows_of_age_[std::min(age, static_cast<std::uint64_t>(rows_of_age_.size() - 1))];
}

/// The age that this share of the rows does not exceed: that of the nearest rank.
std::optional<double> ContactAgeObserver::age_of_rank(double share) const noexcept {
  if (rows_ == 0) return std::nullopt;
  auto left = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(rows_)));
  std::size_t age = 0;
  while (age + 1 < rows_of_age_.size() && rows_of_age_[age] < left) left -= rows_of_age_[age++];
  return dt_ * static_cast<double>(age);
}

void ContactAgeObserver::tell(Section& s) const {
  s.metric("age_p50_s", "s", "half of the rows use contacts found at most so long before", age_of_rank(0.5));
  s.metric("age_p95_s", "s", "95 % of the rows use contacts found at most so long before", age_of_rank(0.95));
  s.metric("age_max_s", "s", "largest time from the query of contacts to a row that uses them",
           if_any(rows_ > 0, dt_ * static_cast<double>(oldest_)));
  s.metric("asked", "1", "times that contacts were asked for, lost ones included", asked_);
  s.metric("lost_share", "1", "share of these that were lost",
           if_any(asked_ > 0, static_cast<double>(lost_) / static_cast<double>(asked_)));
}

void LostTorqueObserver::on_step(const StepRecord& record) noexcept {
  const double squared = record.springs.moment.squaredNorm();
  max_squared_ = std::max(max_squared_, squared);
  if (record.colliding == 0) return;
  ++rows_in_contact_;
  sum_ += std::sqrt(squared);
}

void LostTorqueObserver::tell(Section& s) const {
  const bool any = rows_in_contact_ > 0;
  s.metric("lost_mean_Nm", "Nm",
           "mean ||tau|| of the rows in contact; tau = sum r_i x f_i about the tip's centre is the torque that "
           "the rendered contacts would exert by their shares f_i of f_spring, and that is lost",
           if_any(any, sum_ / static_cast<double>(rows_in_contact_)));
  s.metric("lost_max_Nm", "Nm", "largest ||tau|| of a row", if_any(any, std::sqrt(max_squared_)));
}

void FrictionObserver::begin(const TrialParts& trial) {
  *this = {};
  dt_ = trial.config.dt;
}

void FrictionObserver::on_step(const StepRecord& record) noexcept {
  const Friction now = record.force.friction;
  ++rows_;
  sticking_ += now == Friction::sticks ? 1 : 0;
  sliding_ += now == Friction::slides ? 1 : 0;
  slips_ += now == Friction::slides && last_ == Friction::sticks ? 1 : 0;
  last_ = now;
}

void FrictionObserver::tell(Section& s) const {
  const std::uint64_t with_load = sticking_ + sliding_;
  s.metric("stick_share", "1", "share of the rows with load in which dry friction sticks",
           if_any(with_load > 0, static_cast<double>(sticking_) / static_cast<double>(with_load)));
  s.metric("slips_per_s", "1/s", "times that a sticking tool began to slide, per second of the run",
           if_any(with_load > 0, static_cast<double>(slips_) / (dt_ * static_cast<double>(rows_))));
}

void ForceStageObserver::begin(const TrialParts& trial) {
  *this = {};
  algorithm_ = trial.simulation.algorithm.get();
}

void ForceStageObserver::tell(Section& s) const {
  s.metric("changed_share", "1", "share of the rows in which the force stage changes the force",
           if_any(rows_ > 0, static_cast<double>(work_.steps_staged) / static_cast<double>(rows_)));
  s.metric("taken_J", "J", "energy that the force stage kept the force from giving to the tool, along the way it went",
           if_any(rows_ > 0, work_.energy_staged));
}

}  // namespace hapbench
