#include "scenarios/program/option_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {

double parse_bounded_number(const char* option, const std::string& text, double min, double max) {
  const auto number = finite_number(text);
  if (number && *number >= min && *number <= max) return *number;
  fail_in_option(option, fmt::format("got \"{}\"; allowed: {} ... {}", text, min, max));
}

std::optional<Range> parse_range(const char* option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const Words ends = parts_of(text, ':');
  const auto from = finite_number(ends.front()), to = finite_number(ends.back());
  if (ends.size() != 2 || !from || !to || !(*from < *to))
    fail_in_option(option, fmt::format("got \"{}\"; allowed: a:b with numbers a < b", text));
  return Range{*from, *to};
}

void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds) {
  const Words parts = parts_of(text, '=');
  if (parts.size() == 2) {
    require_valid_option("--bound", std::string(parts[0]), names_of(all_metrics(), &Metric::name),
                         "hapbench describe metrics");
    // A single number is the maximum; min:max gives both bounds.
    const Words ends = parts_of(parts[1], ':');
    const auto min = finite_number(ends.front()), max = finite_number(ends.back());
    if (ends.size() <= 2 && min && max && *min <= *max) {
      MetricBound& bound = bounds[std::string(parts[0])];
      bound.max = *max;
      if (ends.size() == 2) bound.min = *min;
      return;
    }
  }
  fail_in_option("--bound",
                 fmt::format("got \"{}\"; allowed: METRIC=MAX or METRIC=MIN:MAX, such as inside_settled_m=3e-4", text));
}

void require_bounded_metrics(const std::map<std::string, MetricBound>& bounds,
                             const std::vector<LoadedScenario>& scenes) {
  const auto is_depth = [](const std::string& name) {
    return name.starts_with("inside_") || name == "centre_inside_share";
  };
  for (const auto& entry : bounds) {
    const std::string& name = entry.first;
    const auto has_value = [&](const LoadedScenario& scene) {
      const bool has_inside = !std::holds_alternative<SpringsEnvironment>(scene.scenario.environment);
      return find_metric(metrics_without_values(scene), name) != nullptr && (has_inside || !is_depth(name));
    };
    if (std::ranges::any_of(scenes, has_value)) continue;
    const std::string condition = is_depth(name) ? "with a surface; springs have no inside" : condition_of_metric(name);
    fail_in_option("--bound", fmt::format("got \"{}\"; \"{}\" has no such metric: runs have it only {}", name,
                                          scenes.front().scenario.name, condition));
  }
}

}  // namespace hapbench
