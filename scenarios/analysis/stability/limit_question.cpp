#include "scenarios/analysis/stability/limit_question.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/analysis/current_value.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

/// Returns the farthest value that the field allows among current * 2^(sign * n), n = 10, 9, …, 0.
double allowed_end(const LimitQuestion& question, double current, int sign) {
  for (int doublings = 10; doublings > 0; --doublings) {
    const double end = std::ldexp(current, sign * doublings);
    try {
      question.at(end);
      return end;
    } catch (const InputError&) {  // not allowed: try a value closer to the current value
    }
  }
  return current;
}

/// Returns true if the field allows whole numbers in the range, and no number between them. Used for a field that the
/// scenario does not give, and whose type is therefore not known from its value.
bool allows_only_whole_numbers(const LimitQuestion& question, const Range& range) {
  const auto is_allowed = [&](double value) {
    try {
      question.at(value);
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  const double whole = std::ceil(range.from);
  return whole + 1.0 <= range.to && is_allowed(whole) && is_allowed(whole + 1.0) && !is_allowed(whole + 0.5);
}

/// Throws InputError if the tool cannot move freely or the run is too short to classify.
void check_scene(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  if (!position_is_free(scenario.motion))
    fail_in({.file = loaded.file, .pointer = "/motion/position/type"},
            "a prescribed tool cannot become unstable; allowed for limit and tune: \"free\"");
  if (scenario.time.steps < 4)
    fail_in({.file = loaded.file, .pointer = "/time/steps"},
            fmt::format("got {}; allowed for limit and tune: at least 4", scenario.time.steps));
}

/// Returns the range from 2^-10 to 2^10 times the current value, narrowed to values that the field allows. Throws
/// InputError if the current value is not a number above 0.
Range default_range(const LimitQuestion& question, const Json& current) {
  // For a field that does not exist or is not a number, question.at() throws a more specific error.
  if (!current.is_number()) question.at(1.0);
  if (!current.is_number() || !(current.get<double>() > 0.0))
    fail_in({.about_options = {"--vary"}},
            fmt::format("--vary {}: {} in the scenario; allowed without --between: a number > 0", question.path,
                        current.is_null() ? "not given" : current.dump()));
  const double value = current.get<double>();
  return {allowed_end(question, value, -1), allowed_end(question, value, 1)};
}

}  // namespace

std::string override_of(const LimitQuestion& question, double value) {
  return question.search.whole ? fmt::format("{}={:.0f}", question.path, value)
                               : fmt::format("{}={}", question.path, value);
}

LoadedScenario LimitQuestion::at(double value) const {
  std::vector<std::string> all = overrides;
  all.push_back(override_of(*this, value));
  return load_scenario(*scene, all);
}

LimitQuestion limit_question(const ScenarioText& scenario, const std::vector<std::string>& overrides,
                             const std::string& path, std::optional<Range> range) {
  const LoadedScenario loaded = load_scenario(scenario, overrides);
  check_scene(loaded);
  const Json current = current_value(loaded.scenario, path);
  LimitQuestion question;
  question.scene = &scenario;
  question.overrides = overrides;
  question.path = path;
  question.search.whole =
      current.is_number_integer() || (current.is_null() && range && allows_only_whole_numbers(question, *range));
  // Both ends of the range must be allowed values.
  const Range searched = range ? *range : default_range(question, current);
  question.at(searched.from);
  const LoadedScenario last = question.at(searched.to);
  question.warnings = with_files(last, last.warnings);
  question.search.range = {searched.from, searched.to, searched.from > 0.0};
  if (current.is_number() && current.get<double>() >= searched.from && current.get<double>() <= searched.to)
    question.search.current = current.get<double>();
  return question;
}

}  // namespace hapbench
