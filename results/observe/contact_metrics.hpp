#pragma once

#include <cstdint>
#include <vector>

#include "results/io/columns.hpp"
#include "sim/contact/late_contacts.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// How old the contacts are that a run uses: the time from a query to the rows in which its answer serves.
struct ContactAge {
  std::uint64_t rows = 0;                  ///< that have an answer
  double p50 = 0.0, p95 = 0.0, max = 0.0;  ///< of these rows [s]
  std::uint64_t queries = 0;
  double lost_share = 0.0;
};

MetricList metric_list(const ContactAge& age);

/// Counts the rows of each age. Memory is allocated in the constructor: a number for each row of the run, for a million
/// at most.
class ContactAgeObserver final : public Observer {
 public:
  /// `contacts` must outlive the observer.
  ContactAgeObserver(const LateContacts& contacts, double dt, std::uint64_t steps);

  void on_step(const StepRecord& record) noexcept override;

  /// The metrics of the rows seen so far.
  ContactAge metrics() const noexcept;

 private:
  double age_of_rank(double share) const noexcept;

  const LateContacts& contacts_;
  double dt_;
  std::uint64_t rows_ = 0, oldest_ = 0;
  std::uint64_t asked_ = 0, lost_ = 0;
  std::vector<std::uint64_t> rows_of_age_;  ///< by samples; the last entry has all that are older, too
};

/// The torque on the tool that a device of three degrees of freedom cannot render.
struct LostTorqueMetrics {
  std::uint64_t rows_in_contact = 0;  ///< rows with a colliding point
  double mean = 0.0;                  ///< mean ||tau|| of these rows [N m]; 0 without any
  double max = 0.0;                   ///< largest ||tau|| of a row [N m]
};

MetricList metric_list(const LostTorqueMetrics& torque);

/// Observes the lost torque (thesis Fig. 1), tau = sum r_i x f_i about the tip centre, where f_i is the contribution of
/// contact i to f_spring (SpringState::moment) and r_i its place relative to the tip centre. A device of three degrees
/// of freedom renders sum f_i and no torque. Constant memory, a nanosecond a row.
class LostTorqueObserver final : public Observer {
 public:
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// The metrics of the rows seen so far.
  LostTorqueMetrics metrics() const noexcept;

 private:
  std::uint64_t rows_in_contact_ = 0;
  double sum_ = 0.0;
  double max_squared_ = 0.0;
};

}  // namespace hapbench
