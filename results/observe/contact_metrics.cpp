#include "results/observe/contact_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

constexpr std::uint64_t kMostAges = 1'000'000;

}  // namespace

ContactAgeObserver::ContactAgeObserver(const LateContacts& contacts, double dt, std::uint64_t steps)
    : contacts_(contacts), dt_(dt), rows_of_age_(std::min(steps, kMostAges) + 1) {}

void ContactAgeObserver::on_step(const StepRecord& record) noexcept {
  asked_ = contacts_.asked();
  lost_ = contacts_.lost();
  const LateContacts::Query* query = contacts_.used();
  if (query == nullptr) return;
  const std::uint64_t age = record.step - query->row;
  ++rows_;
  oldest_ = std::max(oldest_, age);
  ++rows_of_age_[std::min(age, static_cast<std::uint64_t>(rows_of_age_.size() - 1))];
}

/// The age that this share of the rows does not exceed: that of the nearest rank.
double ContactAgeObserver::age_of_rank(double share) const noexcept {
  auto left = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(rows_)));
  std::size_t age = 0;
  while (age + 1 < rows_of_age_.size() && rows_of_age_[age] < left) left -= rows_of_age_[age++];
  return dt_ * static_cast<double>(age);
}

ContactAge ContactAgeObserver::metrics() const noexcept {
  ContactAge age{.rows = rows_, .max = dt_ * static_cast<double>(oldest_), .queries = asked_};
  if (rows_ > 0) age.p50 = age_of_rank(0.5), age.p95 = age_of_rank(0.95);
  if (asked_ > 0) age.lost_share = static_cast<double>(lost_) / static_cast<double>(asked_);
  return age;
}

MetricList metric_list(const ContactAge& a) {
  const bool any = a.rows > 0;
  return {{"age_p50_s", "s", "half of the rows use contacts found at most so long before", if_any(any, a.p50)},
          {"age_p95_s", "s", "95 % of the rows use contacts found at most so long before", if_any(any, a.p95)},
          {"age_max_s", "s", "largest time from the query of contacts to a row that uses them", if_any(any, a.max)},
          {"asked", "1", "times that contacts were asked for, lost ones included", a.queries},
          {"lost_share", "1", "share of these that were lost", if_any(a.queries > 0, a.lost_share)}};
}

void LostTorqueObserver::on_step(const StepRecord& record) noexcept {
  const double squared = record.springs.moment.squaredNorm();
  max_squared_ = std::max(max_squared_, squared);
  if (record.colliding == 0) return;
  ++rows_in_contact_;
  sum_ += std::sqrt(squared);
}

LostTorqueMetrics LostTorqueObserver::metrics() const noexcept {
  const double mean = rows_in_contact_ > 0 ? sum_ / static_cast<double>(rows_in_contact_) : 0.0;
  return {rows_in_contact_, mean, std::sqrt(max_squared_)};
}

MetricList metric_list(const LostTorqueMetrics& m) {
  return {{"lost_mean_Nm", "Nm",
           "mean ||tau|| of the rows in contact; tau = sum r_i x f_i about the tip's centre is the torque that "
           "the rendered contacts would exert by their shares f_i of f_spring, and that is lost",
           if_any(m.rows_in_contact > 0, m.mean)},
          {"lost_max_Nm", "Nm", "largest ||tau|| of a row", if_any(m.rows_in_contact > 0, m.max)}};
}

}  // namespace hapbench
