#include "sim/contact/contact_trace.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

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

}  // namespace hapbench
