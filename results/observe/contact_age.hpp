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

}  // namespace hapbench
