#include "sim/contact/contact_source.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim/contact/neighbour_list_query.hpp"

namespace hapbench {

std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips) {
  if (skips == Skips::off) return std::make_unique<ShellQuery>(shell, tool);
  return std::make_unique<NeighbourListQuery>(shell, tool);
}

ShellQuery::ShellQuery(const PointShell& shell, const ToolShape& tool)
    : shell_(&shell), tool_(&tool), marks_(shell.padded_size() / simd::lanes) {}

void ShellQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  const PointShell& shell = *shell_;
  const PackRange all{0, marks_.size()};
  tool_->mark_inside(pose, {shell.x(), shell.y(), shell.z()}, {&all, 1}, marks_.data());

  contacts.clear();
  for (std::size_t pack = 0; pack < marks_.size(); ++pack) {
    for (std::uint8_t hits = marks_[pack]; hits != 0; hits &= static_cast<std::uint8_t>(hits - 1)) {
      const std::size_t i = pack * simd::lanes + static_cast<std::size_t>(std::countr_zero(hits));
      const SurfacePoint point = shell.point(i);
      contacts.push(static_cast<std::uint32_t>(i), point.position, point.normal);
    }
  }
  ++work_.queries;
  work_.points_tested += shell.size();
}

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

}  // namespace hapbench
