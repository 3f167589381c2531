#include "scenarios/batch/grid.hpp"

#include <fmt/format.h>

#include <set>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

Grid::Grid(std::vector<Axis> axes) : axes_(std::move(axes)) {
  std::set<std::string> paths;
  double size = 1.0;  // a product that overflows integers is told as well
  for (const Axis& axis : axes_) {
    if (!paths.insert(axis.path).second) {
      throw InputError(fmt::format("--vary: got \"{}\" twice; allowed: each field once", axis.path));
    }
    size *= static_cast<double>(axis.values.size());
  }
  if (size > static_cast<double>(kMostRuns)) {
    throw InputError(fmt::format("--vary: got a grid of {:.7g} runs; allowed: at most {}", size, kMostRuns));
  }
  size_ = static_cast<std::size_t>(size);
}

std::vector<std::string> Grid::values(std::size_t run) const {
  std::vector<std::string> values(axes_.size());
  for (std::size_t a = axes_.size(); a-- > 0;) {
    const std::vector<std::string>& all = axes_[a].values;
    values[a] = all[run % all.size()];
    run /= all.size();
  }
  return values;
}

std::vector<std::string> Grid::overrides(std::size_t run) const {
  std::vector<std::string> overrides = values(run);
  for (std::size_t a = 0; a < axes_.size(); ++a) overrides[a].insert(0, axes_[a].path + "=");
  return overrides;
}

}  // namespace hapbench
