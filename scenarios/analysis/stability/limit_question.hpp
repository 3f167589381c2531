#pragma once

#include <optional>
#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/stability/stability_rule.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// The inputs of a search for a stability limit: a field of a scene, the range of its values, and the rule that decides
/// whether a run is stable.
namespace hapbench {

inline constexpr const char* kStiffnessPath = parameter::kStiffness.field;

/// Inputs of field_limit().
struct LimitQuestion {
  const ScenarioText* scene = nullptr;  ///< not owned; must outlive this object
  std::vector<std::string> overrides = {};
  std::string path = {};  ///< path of the field, dotted as in --set
  IntervalSearchOptions search = {};
  StabilityRule rule = {};
  std::vector<std::string> warnings = {};  ///< warnings of the scenario with the field at the upper end of the range
  bool between = true;                     ///< true: further samples verify the interval (find_verified_interval)
  unsigned threads = 1;                    ///< number of parallel runs; does not change the result

  const char* side() const { return search.smallest ? "smallest" : "largest"; }
  /// Loads the scene with the field set to `value`. Throws InputError.
  LoadedScenario at(double value) const;
};

/// Returns the override that sets the question's field to `value`.
std::string override_of(const LimitQuestion& question, double value);

/// Returns the inputs of a search for the limit of the field at `path`. Without `range`, searches from 2^-10 to 2^10
/// times the scenario's value, narrowed to values that the field allows. The search is logarithmic if both ends of the
/// range are above 0.
///
/// Throws InputError, with the file, if the tool's position is prescribed, if there are fewer than 4 steps, if the
/// field is not a number, if the field does not allow an end of the range, or if `range` is empty and the scenario's
/// value is not above 0.
LimitQuestion limit_question(const ScenarioText& scenario, const std::vector<std::string>& overrides,
                             const std::string& path, std::optional<Range> range);

}  // namespace hapbench
