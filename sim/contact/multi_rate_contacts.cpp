#include "sim/contact/multi_rate_contacts.hpp"

#include <utility>

namespace hapbench {

MultiRateContacts::MultiRateContacts(std::unique_ptr<ContactSource> source, const MultiRateSchedule& timing,
                                     bool may_pull, std::uint64_t seed)
    : source_(std::move(source)),
      may_pull_(may_pull),
      seed_(seed),
      random_(seed),
      waiting_(static_cast<std::size_t>(timing.delay / timing.every) + 1),
      found_(source_->capacity()) {
  schedule_.timing = timing;
  source_->follow(&schedule_.latest.row);
}

void MultiRateContacts::reset() noexcept {
  source_->reset();
  fault_ = nullptr;
  random_ = Random(seed_);
  calls_ = schedule_.queries = schedule_.lost = 0;
  last_step_.reset();
  first_ = count_ = 0;
  schedule_.has_result = false;
  found_.clear();
}

void MultiRateContacts::begin_step(std::uint64_t row, const ToolPose& pose) noexcept {
  const MultiRateSchedule& timing = schedule_.timing;

  // Send a query if a query is scheduled in this step.
  if (row % static_cast<std::uint64_t>(timing.every) == 0) {
    const bool is_lost = schedule_.queries++ > 0 && timing.dropout > 0.0 && random_.uniform() < timing.dropout;
    if (is_lost)
      ++schedule_.lost;
    else
      waiting_[(first_ + count_++) % waiting_.size()] = {pose, row};
  }

  // Take the result that is due. At most one result is due in a step, because all queries have the same delay.
  if (count_ == 0 || waiting_[first_].row + static_cast<std::uint64_t>(timing.delay) > row) return;
  schedule_.latest = waiting_[first_];
  first_ = (first_ + 1) % waiting_.size();
  --count_;
  schedule_.has_result = true;
  source_->contacts_at(schedule_.latest.pose, found_);
  fault_ = source_->fault();
}

void MultiRateContacts::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  // Integrators that query again within a step get the contacts of the step.
  const std::uint64_t row = row_ != nullptr ? *row_ : calls_++;
  if (row != last_step_) begin_step(row, pose);
  last_step_ = row;

  if (schedule_.timing.linear && !found_.empty())
    move_found_to(pose, contacts);
  else
    contacts.assign(found_);
}

void MultiRateContacts::move_found_to(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  contacts.clear();
  const ToolPose& from = schedule_.latest.pose;
  const Vec3 moved = pose.position - from.position;
  const Mat3 turned = turn_matrix(from, pose) - Mat3::Identity();
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const Vec3 displacement = moved + turned * (found_.point(i) - from.position);
    const double depth = found_.depth[i] + found_.gradient(i).dot(displacement);
    if (!(depth > 0.0) && !may_pull_) continue;
    contacts.push_copy_of(found_, i);
    contacts.depth[contacts.size() - 1] = depth;
  }
  contacts.pad();
}

}  // namespace hapbench
