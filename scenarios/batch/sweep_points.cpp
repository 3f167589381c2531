#include "scenarios/batch/sweep_points.hpp"

#include <fmt/format.h>

#include <set>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

void check_paths(const std::vector<Axis>& axes) {
  std::set<std::string> paths;
  for (const Axis& axis : axes) {
    if (paths.insert(axis.path).second) continue;
    throw InputError(fmt::format("--vary: got \"{}\" twice; allowed: each field once", axis.path));
  }
}

}  // namespace

SweepPoints::SweepPoints(std::vector<Axis> axes) : axes_(std::move(axes)) {
  check_paths(axes_);
  double size = 1.0;  // a product that overflows integers is told as well
  for (const Axis& axis : axes_) size *= static_cast<double>(axis.size());
  if (size > static_cast<double>(kMostRuns)) {
    throw InputError(fmt::format("--vary: got a grid of {:.7g} runs; allowed: at most {}", size, kMostRuns));
  }
  strides_.resize(axes_.size());
  for (std::size_t a = axes_.size(); a-- > 0; size_ *= axes_[a].size()) strides_[a] = size_;
}

SweepPoints::SweepPoints(std::vector<Axis> axes, const Sampling& sampling)
    : axes_(std::move(axes)), sampling_(sampling), size_(sampling.count) {
  check_paths(axes_);
  sample_.emplace(sampling, axes_.size());
}

std::size_t SweepPoints::place(std::size_t run, std::size_t axis) const {
  return sample_ ? place_at(axes_[axis], sample_->at(run, axis)) : run / strides_[axis] % axes_[axis].size();
}

std::string SweepPoints::value(std::size_t run, std::size_t axis) const {
  return sample_ ? value_at(axes_[axis], sample_->at(run, axis)) : axes_[axis].value(place(run, axis));
}

std::vector<std::string> SweepPoints::values(std::size_t run) const {
  std::vector<std::string> values(axes_.size());
  for (std::size_t a = 0; a < axes_.size(); ++a) values[a] = value(run, a);
  return values;
}

std::vector<std::string> SweepPoints::overrides(std::size_t run) const {
  std::vector<std::string> overrides = values(run);
  for (std::size_t a = 0; a < axes_.size(); ++a) overrides[a].insert(0, axes_[a].path + "=");
  return overrides;
}

}  // namespace hapbench
