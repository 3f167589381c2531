#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "results/observe/metric_observer.hpp"
#include "sim/contact/late_contacts.hpp"

/// Metrics of contacts and of what is between them and the force on the tool.
namespace hapbench {

/// How old the contacts are that a run uses: the time from a query to the rows in which its answer serves. Counts the
/// rows of each age, for which `begin` allocates a number for each row of the trial, for a million at most.
class ContactAgeObserver final : public MetricObserver {
 public:
  /// Precondition: the trial's contacts are late.
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

 private:
  std::optional<double> age_of_rank(double share) const noexcept;

  const LateContacts* contacts_ = nullptr;
  double dt_ = 0.0;
  std::uint64_t rows_ = 0, oldest_ = 0;
  std::uint64_t asked_ = 0, lost_ = 0;
  std::vector<std::uint64_t> rows_of_age_;  ///< by samples; the last entry also counts all older ones
};

/// Observes the lost torque (thesis Fig. 1), tau = sum r_i x f_i about the tip centre, where f_i is the contribution of
/// contact i to f_spring (SpringState::moment) and r_i its place relative to the tip centre. A device of three degrees
/// of freedom renders sum f_i and no torque. Constant memory, a nanosecond a row.
class LostTorqueObserver final : public MetricObserver {
 public:
  void begin(const TrialParts&) override { *this = {}; }
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

 private:
  std::uint64_t rows_in_contact_ = 0;
  double sum_ = 0.0;
  double max_squared_ = 0.0;
};

/// Counts whether dry friction (algorithms/stages/damping_and_limits.hpp) sticks or slides. Constant memory.
class FrictionObserver final : public MetricObserver {
 public:
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

 private:
  double dt_ = 0.0;
  std::uint64_t rows_ = 0, sticking_ = 0, sliding_ = 0, slips_ = 0;
  Friction last_ = Friction::none;
};

/// Reads how much a force stage changes the force of its algorithm, from the algorithm's work in every row.
class ForceStageObserver final : public MetricObserver {
 public:
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord&) noexcept override {
    ++rows_;
    work_ = algorithm_->work();
  }
  void tell(Section& section) const override;

 private:
  const ForceAlgorithm* algorithm_ = nullptr;
  std::uint64_t rows_ = 0;
  AlgorithmWork work_;
};

}  // namespace hapbench
