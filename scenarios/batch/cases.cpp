#include "scenarios/batch/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more) {
  for (const std::string& text : more)
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
}

/// Throws InputError if two axes have the same path, or if the field of one axis is part of the field of another axis,
/// such as "device.type" and "device", so that one axis would override the other. An axis within another axis is
/// allowed if the outer axis comes first and all values of the outer axis are objects.
static void check_paths(const std::vector<Axis>& axes) {
  const auto is_object = [](const std::string& value) { return value.starts_with("{"); };
  for (auto outer = axes.begin(); outer != axes.end(); ++outer) {
    if (std::ranges::count(axes, outer->path, &Axis::path) > 1)
      fail_in_option(outer->option, fmt::format("got \"{}\" twice; allowed: each field once", outer->path));
    for (auto inner = axes.begin(); inner != axes.end(); ++inner) {
      if (!inner->path.starts_with(outer->path + ".")) continue;
      if (outer < inner && !outer->values.empty() && std::ranges::all_of(outer->values, is_object)) continue;
      fail_in_option(outer->option,
                     fmt::format("got \"{0}\" and \"{1}\", which is a part of it; allowed: one of the two, or objects "
                                 "for {0} before {1}",
                                 outer->path, inner->path));
    }
  }
}

Cases::Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
             std::optional<Sampling> sampling)
    : scenes_(std::move(scenes)), sets_(std::move(sets)), axes_(std::move(axes)), sampling_(std::move(sampling)) {
  check_paths(axes_);
  // Draw the sample, or count the combinations of the grid.
  strides_.resize(axes_.size());
  if (sampling_) {
    size_ = sampling_->count;
    for (std::size_t a = 0; a < axes_.size(); ++a) unit_.push_back(unit_sample(*sampling_, a));
    sampling_->of_file.clear();
  } else {
    double size = 1.0;  // double, because the product may overflow an integer
    for (const Axis& axis : axes_) size *= static_cast<double>(axis.size());
    if (size > static_cast<double>(kMaxRuns))
      fail_in_option("--vary", fmt::format("got a grid of {:.7g} runs; allowed: at most {}", size, kMaxRuns));
    for (std::size_t a = axes_.size(); a-- > 0; size_ *= axes_[a].size()) strides_[a] = size_;
  }
  sort_runs();
}

/// Sorts the cases so that cases with the same environment follow each other and can share a point shell.
/// Ignores axes that are sampled ranges, because each case of a sample has a different value.
void Cases::sort_runs() {
  std::vector<std::size_t> slow;  // indices of the axes that the point shell depends on; the scene is the first
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const std::string& path = axes_[a].path;
    if (axes_[a].size() == 0) continue;
    if (path == kSceneAxis) slow.insert(slow.begin(), a);
    if (path == "environment" || path.starts_with("environment.")) slow.push_back(a);
  }
  if (slow.empty()) return;
  // Sort by the values of these axes, and keep the order of cases with equal values.
  sorted_.resize(size_);
  std::iota(sorted_.begin(), sorted_.end(), std::size_t{0});
  std::ranges::stable_sort(sorted_, [&](std::size_t i, std::size_t j) {
    const auto differs =
        std::ranges::find_if(slow, [&](std::size_t a) { return value_index(i, a) != value_index(j, a); });
    return differs != slow.end() && value_index(i, *differs) < value_index(j, *differs);
  });
}

std::vector<std::string> Cases::values(std::size_t i) const {
  std::vector<std::string> values(axes_.size());
  for (std::size_t a = 0; a < axes_.size(); ++a) values[a] = value(i, a);
  return values;
}

std::vector<std::string> Cases::changes(std::size_t i) const {
  std::vector<std::string> changes = values(i);
  for (std::size_t a = 0; a < axes_.size(); ++a) changes[a].insert(0, axes_[a].path + "=");
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    if (axes_[a].along.empty()) continue;
    const std::vector<std::string>& more = axes_[a].along[value_index(i, a)].overrides;
    changes.insert(changes.end(), more.begin(), more.end());
  }
  return changes;
}

const ScenarioText& Cases::scene(std::size_t i) const {
  const auto axis = std::ranges::find(axes_, kSceneAxis, &Axis::path);
  return scenes_[axis == axes_.end() ? 0 : value_index(i, static_cast<std::size_t>(axis - axes_.begin()))];
}

std::vector<std::string> Cases::overrides(std::size_t i) const {
  std::vector<std::string> overrides = sets_;
  const std::vector<std::string> all = changes(i);
  for (std::size_t c = 0; c < all.size(); ++c)
    if (c >= axes_.size() || !(axes_[c].named || axes_[c].path == kSceneAxis)) overrides.push_back(all[c]);
  return overrides;
}

InputError Cases::with_line_of_point(const InputError& error, std::size_t i) const {
  const auto is_of_axis = [](const std::string& pointer, const Axis& axis) {
    Json::json_pointer field;
    for (const std::string_view key : parts_of(axis.path, '.')) field.push_back(std::string(key));
    return (pointer + "/").starts_with(field.to_string() + "/");
  };
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    ErrorLocation location = fault.location();
    const bool is_of_point =
        std::ranges::any_of(axes_, [&](const Axis& axis) { return is_of_axis(location.pointer, axis); });
    if (is_of_point) {
      location.option = fmt::format("--points {}, line {}", sampling_->file.string(), sampling_->lines[i]);
      location.about_options.emplace_back("--points");
    }
    faults.emplace_back(fault.kind(), location, fault.problem());
  }
  return InputError::all(faults);
}

LoadedScenario Cases::load_case(std::size_t i) const {
  if (!sampling_ || sampling_->lines.empty()) return load_scenario(scene(i), overrides(i));
  try {
    return load_scenario(scene(i), overrides(i));
  } catch (const InputError& error) {
    throw with_line_of_point(error, i);
  }
}

LoadedScenario Cases::load(std::size_t i) const {
  LoadedScenario loaded = load_case(i);
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (!axes_[a].along.empty()) loaded.scenario.time.stride *= axes_[a].along[value_index(i, a)].stride;
  return loaded;
}

}  // namespace hapbench
