#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "results/io/columns.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

class ReferenceForce;

/// A trial of a run before its first row. Nearly all runs have one trial.
struct TrialParts {
  const SimulationConfig& config;
  const SimulationParts& simulation;          ///< lives until the trial has ended
  const ReferenceForce* reference = nullptr;  ///< null without; lives as long as the run
  std::size_t subject = 0, trial = 0;         ///< of a tracking hand, from 0
};

/// A quotient of counts or sums, such as a mean or a share. Of nothing it is not finite, and so no value of a metric.
inline double per(auto part, auto whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// Takes the metrics of an observer, in the order in which it tells them.
class Section {
 public:
  /// Adds to a list, with `name` and a dot in front of the metrics' names; an empty one adds nothing in front.
  Section(MetricList& list, std::string_view name) : list_(list), prefix_(name) {
    if (!prefix_.empty()) prefix_ += '.';
  }

  /// A metric as Metric describes it. Its name, unit and meaning do not depend on the run. A value that is not finite
  /// is none.
  template <class Given>
  Metric& metric(const std::string& name, const char* unit, const char* meaning, const Given& value,
                 Better better = Better::none) {
    list_.push_back({prefix_ + name, unit, meaning, metric_value(value), better});
    return list_.back();
  }
  /// The section of that name in this one.
  Section part(std::string_view name) const { return {list_, prefix_ + std::string(name)}; }

 private:
  MetricList& list_;
  std::string prefix_;
};

/// An observer that tells what it saw as metrics of summary.json. `tell` is the one place that names and documents
/// them: an observer that saw nothing tells the same list, which is the documentation.
class MetricObserver : public Observer {
 public:
  /// Called before the first row of each trial. Differences between the last row of a trial and the first of the next
  /// must not count: an observer whose numbers make sense over several trials goes on adding, any other starts anew.
  virtual void begin(const TrialParts& trial) = 0;
  virtual void tell(Section& section) const = 0;
  /// Adds the members of its section in summary.json that are not metrics.
  virtual void add_members(nlohmann::ordered_json&) const {}
};

}  // namespace hapbench
