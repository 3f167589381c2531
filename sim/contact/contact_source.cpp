#include "sim/contact/contact_source.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

void SpringSource::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  contacts.clear();
  for (std::size_t j = 0; j < springs_->gradients.size(); ++j) {
    const Vec3& u = springs_->gradients[j];
    const double depth = pose.position.dot(u);
    if (!springs_->bilateral && !(depth > 0.0)) continue;
    const bool turned = !springs_->signed_depths && depth < 0.0;
    push_spring(j, pose.position, turned ? -depth : depth, turned ? Vec3(-u) : u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_->gradients.size();
}

void push_spring(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient,
                 ContactBuffer& contacts) {
  contacts.push(static_cast<std::uint32_t>(spring), position, -gradient);
  contacts.depth[contacts.size() - 1] = depth;
  contacts.set_gradient(contacts.size() - 1, gradient);
}

std::size_t ContactTrace::most() const {
  std::size_t most = 0, end = contacts.size();
  for (auto time = times.rbegin(); time != times.rend(); end = time++->first) most = std::max(most, end - time->first);
  return most;
}

TraceSource::TraceSource(std::shared_ptr<const ContactTrace> trace, double dt)
    : trace_(std::move(trace)), dt_(dt), capacity_(trace_->most()) {}

void TraceSource::contacts_at(const ToolPose&, ContactBuffer& contacts) noexcept {
  const double now = static_cast<double>(row_ != nullptr ? *row_ : work_.queries) * dt_;
  ++work_.queries;
  contacts.clear();
  const auto& times = trace_->times;
  auto at = std::partition_point(times.begin(), times.end(), [now](const auto& t) { return t.time < now; });
  // The time before may be nearer.
  if (at != times.begin() && (at == times.end() || now - std::prev(at)->time < at->time - now)) --at;
  if (at != times.end() && std::abs(at->time - now) <= 0.5 * dt_) {
    const std::size_t end = std::next(at) == times.end() ? trace_->contacts.size() : std::next(at)->first;
    for (std::size_t i = at->first; i < end; ++i) {
      const auto& [point, gradient, depth] = trace_->contacts[i];
      push_spring(i - at->first, point, depth, gradient, contacts);
    }
  }
  contacts.pad();
}

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
