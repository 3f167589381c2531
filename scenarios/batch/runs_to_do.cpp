#include "scenarios/batch/runs_to_do.hpp"

#include <algorithm>

namespace hapbench {
namespace {

bool is_of_environment(const Axis& axis) {
  return axis.path == "environment" || axis.path.starts_with("environment.");
}

/// The axes by whose values runs can be put in order: each point of a sampled range is one of its own.
std::vector<std::size_t> environment_axes(const SweepPoints& points) {
  std::vector<std::size_t> axes;
  for (std::size_t a = 0; a < points.axes().size(); ++a) {
    if (is_of_environment(points.axes()[a]) && points.axes()[a].size() > 1) axes.push_back(a);
  }
  return axes;
}

}  // namespace

std::string environment_of(const SweepPoints& points, std::size_t run) {
  std::string environment;
  for (std::size_t a = 0; a < points.axes().size(); ++a) {
    // No value has a line break.
    if (is_of_environment(points.axes()[a])) environment += points.value(run, a) + "\n";
  }
  return environment;
}

RunsToDo::RunsToDo(const SweepPoints& points, const Shard& shard) : shard_(shard), count_(shard.size(points.size())) {
  const std::vector<std::size_t> axes = environment_axes(points);
  if (axes.empty()) return;
  order_.reserve(count_);
  for (std::size_t run = shard.index; run < points.size(); run += shard.count) {
    std::uint32_t environment = 0;  // where there are more than fit, two with one number take turns
    for (const std::size_t a : axes) {
      environment = environment * static_cast<std::uint32_t>(points.axes()[a].size()) +
                    static_cast<std::uint32_t>(points.place(run, a));
    }
    order_.push_back(std::uint64_t{environment} << 32 | run);
  }
  std::sort(order_.begin(), order_.end());
}

std::optional<std::size_t> RunsToDo::next() {
  if (given_ == count_) return std::nullopt;
  const std::size_t i = given_++;
  return order_.empty() ? shard_.index + i * shard_.count : order_[i] & 0xffffffff;
}

}  // namespace hapbench
