#include "sim/contact/trace_source.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/contact/spring_source.hpp"

namespace hapbench {

std::size_t ContactTrace::end_of(std::size_t i) const {
  return i + 1 < times.size() ? times[i + 1].first : contacts.size();
}

std::size_t ContactTrace::max_contacts() const {
  std::size_t largest = 0;
  for (std::size_t i = 0; i < times.size(); ++i) largest = std::max(largest, end_of(i) - times[i].first);
  return largest;
}

TraceSource::TraceSource(std::shared_ptr<const ContactTrace> trace, double dt)
    : trace_(std::move(trace)), dt_(dt), capacity_(trace_->max_contacts()) {}

void TraceSource::contacts_at(const ToolPose&, ContactBuffer& contacts) noexcept {
  const double now = static_cast<double>(row_ != nullptr ? *row_ : work_.queries) * dt_;
  ++work_.queries;
  contacts.clear();

  // Find the recorded time nearest to the time of the step: either the first recorded time that is not before the step,
  // or the last recorded time before the step.
  const auto& times = trace_->times;
  auto at = std::partition_point(times.begin(), times.end(), [now](const auto& t) { return t.time < now; });
  if (at != times.begin() && (at == times.end() || now - std::prev(at)->time < at->time - now)) --at;

  // Copy the contacts of this time if it is at most half a step away from the time of the step.
  if (at != times.end() && std::abs(at->time - now) <= kTraceWindow * dt_) {
    const std::size_t end = trace_->end_of(static_cast<std::size_t>(at - times.begin()));
    for (std::size_t i = at->first; i < end; ++i) {
      const auto& [point, gradient, depth] = trace_->contacts[i];
      push_spring(i - at->first, point, depth, gradient, contacts);
    }
  }
  contacts.pad();
}

}  // namespace hapbench
