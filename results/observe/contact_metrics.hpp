#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "results/observe/metric_observer.hpp"
#include "sim/contact/contact_schedule.hpp"

/// Metrics of contacts and of the processing steps between contacts and the force on the tool.
namespace hapbench {

/// Measures the age of the contacts that a run uses. The age in a step is the time since the contact query whose result
/// the step uses. For each age, counts the steps that use contacts of this age. `begin` allocates one counter for each
/// step of the trial, at most about a million counters.
class ContactAgeObserver final : public MetricObserver {
 public:
  /// Precondition: the source of the trial's contacts has a schedule.
  void begin(const TrialParts& trial) override {
    constexpr std::uint64_t kMaxAges = 1'000'000;
    *this = {};
    schedule_ = trial.simulation.source->schedule();
    dt_ = trial.config.dt;
    rows_of_age_.resize(std::min(trial.config.steps, kMaxAges) + 1);
  }
  void on_step(const StepRecord& record) noexcept override {
    requested_ = schedule_->queries;
    lost_ = schedule_->lost;
    const ContactSchedule::Query* query = schedule_->used();
    if (query == nullptr) return;
    const std::uint64_t age = record.step - query->row;
    ++rows_;
    oldest_ = std::max(oldest_, age);
    ++rows_of_age_[std::min(age, static_cast<std::uint64_t>(rows_of_age_.size() - 1))];
  }
  void report(Section& s) const override {
    s.metric(
        "age_p50_s", "s",
        "median age of the contacts in use, from the contact query to the step that uses its result (written to no "
        "file); no value if no step used contacts",
        age_of_rank(0.5));
    s.metric(
        "age_p95_s", "s",
        "95th percentile of the age of the contacts in use, from the contact query to the step that uses its result; "
        "no value if no step used contacts",
        age_of_rank(0.95));
    s.metric(
        "age_max_s", "s",
        "largest age of the contacts in use, from the contact query to the step that uses its result; no value if no "
        "step used contacts",
        if_any(rows_ > 0, dt_ * static_cast<double>(oldest_)));
    s.metric("searches", "1", "number of contact queries (written to no file), including queries whose result was lost",
             requested_);
    s.metric("lost_share", "1",
             "fraction of the contact queries (contacts.searches) whose result was lost; no value without a query",
             per(lost_, requested_));
  }

 private:
  /// Returns a quantile of the age over all steps that used contacts, by nearest rank: the smallest age [s] that is not
  /// exceeded in at least the fraction `share` of these steps. Empty if no step used contacts.
  std::optional<double> age_of_rank(double share) const noexcept {
    if (rows_ == 0) return std::nullopt;
    auto left = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(rows_)));
    std::size_t age = 0;
    while (age + 1 < rows_of_age_.size() && rows_of_age_[age] < left) left -= rows_of_age_[age++];
    return dt_ * static_cast<double>(age);
  }

  const ContactSchedule* schedule_ = nullptr;
  double dt_ = 0.0;
  std::uint64_t rows_ = 0, oldest_ = 0;
  std::uint64_t requested_ = 0, lost_ = 0;
  /// Entry i: number of steps that used contacts of the age i [time steps]. The last entry also counts the steps that
  /// used older contacts.
  std::vector<std::uint64_t> rows_of_age_;
};

/// Observes the lost torque (thesis Fig. 1), tau = sum r_i x f_i about the tip centre. f_i is the part of f_spring due
/// to contact i (SpringState::moment), r_i the contact's position relative to the tip centre. A device with three
/// degrees of freedom renders sum f_i but no torque. Constant memory; about 1 ns a step.
class LostTorqueObserver final : public MetricObserver {
 public:
  void begin(const TrialParts&) override { *this = {}; }
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override {
    const double squared = record.springs.moment.squaredNorm();
    max_squared_ = std::max(max_squared_, squared);
    if (record.colliding == 0) return;
    ++rows_in_contact_;
    sum_ += std::sqrt(squared);
  }
  void report(Section& s) const override {
    s.metric(
        "lost_mean_Nm", "Nm",
        "mean norm of the lost torque (tx_Nm, ty_Nm, tz_Nm of trajectory.csv) over the steps in contact, mean ||tau|| "
        "with tau = sum r_i x f_i about the "
        "tip's centre, where contact i contributes f_i to f_spring: torque that the contacts exert and a 3-DOF device "
        "cannot render; no value without contact",
        per(sum_, rows_in_contact_));
    s.metric("lost_max_Nm", "Nm",
             "largest norm of the lost torque (tx_Nm, ty_Nm, tz_Nm of trajectory.csv), max ||tau||, as in "
             "torque.lost_mean_Nm; no value "
             "without contact",
             if_any(rows_in_contact_ > 0, std::sqrt(max_squared_)));
  }

 private:
  std::uint64_t rows_in_contact_ = 0;
  double sum_ = 0.0;
  double max_squared_ = 0.0;
};

/// Counts the steps in which dry friction (algorithms/stages/damping_and_limits.hpp) sticks or slides. Constant
/// memory.
class FrictionObserver final : public MetricObserver {
 public:
  void begin(const TrialParts& trial) override {
    *this = {};
    dt_ = trial.config.dt;
  }
  void on_step(const StepRecord& record) noexcept override {
    const Friction now = record.force.friction;
    ++rows_;
    sticking_ += now == Friction::sticks;
    sliding_ += now == Friction::slides;
    slips_ += now == Friction::slides && last_ == Friction::sticks;
    last_ = now;
  }
  void report(Section& s) const override {
    const std::uint64_t with_load = sticking_ + sliding_;
    s.metric(
        "stick_share", "1",
        "fraction of the steps with a friction load in which dry friction sticks (instead of sliding); no value if no "
        "step has a friction load; the state of each step is written to no file",
        per(sticking_, with_load));
    s.metric(
        "slips_per_s", "1/s",
        "number of changes from sticking to sliding per second of the run; no value if no step has a friction load; "
        "the state of each step is written to no file",
        if_any(with_load > 0, per(slips_, dt_ * static_cast<double>(rows_))));
  }

 private:
  double dt_ = 0.0;
  std::uint64_t rows_ = 0, sticking_ = 0, sliding_ = 0, slips_ = 0;
  Friction last_ = Friction::none;
};

/// Measures how much a force stage changes the force of its algorithm, from the algorithm's work counters.
class ForceStageObserver final : public MetricObserver {
 public:
  void begin(const TrialParts& trial) override {
    *this = {};
    algorithm_ = trial.simulation.algorithm.get();
  }
  void on_step(const StepRecord&) noexcept override {
    ++rows_;
    work_ = algorithm_->work();
  }
  void report(Section& s) const override {
    s.metric(
        "changed_share", "1",
        "fraction of the steps in which the force stage changes the force; counted during the run, written to no file",
        per(work_.steps_staged, rows_));
    s.metric(
         "removed_J", "J",
         "energy that the force stage removed: force change of the stage, integrated along the tool's path; the force "
         "before the stage is written to no file",
         if_any(rows_ > 0, work_.energy_staged))
        .has_either_sign();
  }

 private:
  const ForceAlgorithm* algorithm_ = nullptr;
  std::uint64_t rows_ = 0;
  AlgorithmWork work_;
};

}  // namespace hapbench
