#include "sim/contact/late_contacts.hpp"

namespace hapbench {

LateContacts::LateContacts(std::unique_ptr<ContactSource> source, const Lateness& lateness, bool may_pull,
                           std::uint64_t seed)
    : source_(std::move(source)),
      lateness_(lateness),
      may_pull_(may_pull),
      seed_(seed),
      random_(seed),
      waiting_(static_cast<std::size_t>(lateness.delay / lateness.every) + 1),
      found_(source_->capacity()) {
  source_->follow(&used_.row);
}

void LateContacts::reset() noexcept {
  source_->reset();
  fault_ = nullptr;
  random_ = Random(seed_);
  calls_ = asked_ = lost_ = 0;
  last_row_.reset();
  first_ = count_ = 0;
  serves_ = false;
  found_.clear();
}

/// Sends the query of the row, if it has one, and takes up the answer that comes due. At most one does, because each
/// query takes as long.
void LateContacts::begin_row(std::uint64_t row, const ToolPose& pose) noexcept {
  if (row % static_cast<std::uint64_t>(lateness_.every) == 0) {
    const bool is_lost = asked_++ > 0 && lateness_.dropout > 0.0 && random_.uniform() < lateness_.dropout;
    if (is_lost)
      ++lost_;
    else
      waiting_[(first_ + count_++) % waiting_.size()] = {pose, row};
  }
  if (count_ == 0 || waiting_[first_].row + static_cast<std::uint64_t>(lateness_.delay) > row) return;
  used_ = waiting_[first_];
  first_ = (first_ + 1) % waiting_.size();
  --count_;
  serves_ = true;
  source_->contacts_at(used_.pose, found_);
  fault_ = source_->fault();
}

void LateContacts::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  const std::uint64_t row = row_ != nullptr ? *row_ : calls_++;
  if (row != last_row_) begin_row(row, pose);
  last_row_ = row;
  if (!lateness_.linear || found_.empty()) return contacts.assign(found_);
  contacts.clear();
  const Vec3 moved = pose.position - used_.pose.position;
  const Mat3 turned = turn_matrix(used_.pose, pose) - Mat3::Identity();
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const Vec3 way = moved + turned * (found_.point(i) - used_.pose.position);
    const double depth = found_.depth[i] + found_.gradient(i).dot(way);
    if (!(depth > 0.0) && !may_pull_) continue;
    contacts.push_copy_of(found_, i);
    contacts.depth[contacts.size() - 1] = depth;
  }
  contacts.pad();
}

}  // namespace hapbench
