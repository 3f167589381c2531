#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "results/io/columns.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

class ReferenceForce;

/// A trial of a run before its first step. Most runs have one trial.
struct TrialParts {
  const SimulationConfig& config;
  const SimulationParts& simulation;          ///< valid until the trial ends
  const ReferenceForce* reference = nullptr;  ///< null: no reference force; valid until the run ends
  std::size_t subject = 0, trial = 0;         ///< numbers of subject and trial of a tracking hand, from 0
};

/// Returns part / whole, such as a mean or a fraction. If `whole` is 0, the result is not finite, and a metric with
/// this number has no value.
inline double per(auto part, auto whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// Collects the metrics of an observer in a list, in the order of the calls of `metric`.
class Section {
 public:
  /// Appends to `list`. The metrics' names are prefixed with `name` and a dot; an empty `name` adds no prefix.
  Section(MetricList& list, std::string_view name) : list_(list), prefix_(name) {
    if (!prefix_.empty()) prefix_ += '.';
  }

  /// Appends a metric; the arguments are as in Metric. Name, unit and meaning must not depend on the run. For a value
  /// that is not finite, the metric gets no value.
  template <class Given>
  Metric& metric(const std::string& name, const char* unit, const char* meaning, const Given& value,
                 Better better = Better::none) {
    list_.push_back({prefix_ + name, unit, meaning, metric_value(value), better});
    return list_.back();
  }
  /// Returns the subsection with this name.
  Section part(std::string_view name) const { return {list_, prefix_ + std::string(name)}; }

 private:
  MetricList& list_;
  std::string prefix_;
};

/// An observer that reports metrics of summary.json. Only its function `report` names and documents the metrics:
/// without data, an observer reports the same list with empty values, which serves as documentation.
class MetricObserver : public Observer {
 public:
  /// Called before the first step of each trial. Differences between the last step of a trial and the first step of the
  /// next must not count. An observer whose metrics are meaningful over several trials continues its sums; any other
  /// observer resets its sums.
  virtual void begin(const TrialParts& trial) = 0;
  /// Reports all metrics. Called after the run, or without any run for documentation.
  virtual void report(Section& section) const = 0;
  /// Adds the members of the observer's section in summary.json that are not metrics. Adds nothing by default.
  virtual void add_members(nlohmann::ordered_json&) const {}
};

}  // namespace hapbench
