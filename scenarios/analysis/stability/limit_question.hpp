#pragma once

#include <optional>
#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/stability/stability_rule.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// The question for a stability limit: a field of a scene, the range to search, and the rule by which a run is stable.
namespace hapbench {

inline constexpr const char* kStiffnessPath = parameter::kStiffness.field;

struct LimitQuestion {
  const ScenarioText* scene = nullptr;  ///< must outlive the question
  std::vector<std::string> overrides = {};
  std::string path = {};  ///< of the field, dotted as in --set
  SearchWay search = {};
  StabilityRule rule = {};
  std::vector<std::string> warnings = {};  ///< of the scenario with the field given
  bool between = true;                     ///< the interval is verified by samples between its ends (find_tried_edge)
  unsigned threads = 1;                    ///< runs at once; no result depends on it

  const char* side() const { return search.smallest ? "smallest" : "largest"; }
  /// Returns the scene with this value of the field. Throws InputError.
  LoadedScenario at(double value) const;
};

/// Asks for the limit of a field in a range. The default range is a thousandth to a thousandfold (2^10) of the
/// scenario's current value, as far as the field allows it. The range is searched in ratios if both ends are above 0.
/// Throws InputError, with the file, for a scene without a free position or with fewer than 4 steps, if the field is
/// not a number, if it does not allow the ends of the range, and, without a range, if its current value is not above 0.
LimitQuestion limit_question(const ScenarioText& scenario, const std::vector<std::string>& overrides,
                             const std::string& path, std::optional<Range> range);

}  // namespace hapbench
