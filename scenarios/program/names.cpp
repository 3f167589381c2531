#include "scenarios/program/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "algorithms/registry.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& requested) {
  if (!requested.empty()) {
    require_valid_option("--metric", requested, metrics, "hapbench describe metrics");
    return requested;
  }
  const auto has = [&](std::string_view name) { return std::ranges::find(metrics, name) != metrics.end(); };
  return std::string(*std::find_if(std::begin(kDefaultMetrics), std::end(kDefaultMetrics) - 1, has));
}

void require_names(const std::string& option, const std::vector<std::string>& names,
                   const std::vector<std::string>& valid, std::string_view shown_by) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    require_valid_option(option, name, valid, shown_by);
    if (!seen.insert(name).second) fail_in_option(option, fmt::format("got \"{}\" twice; allowed: once", name));
  }
}

std::vector<std::string> chosen_names(const std::string& option, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all, std::string_view shown_by) {
  if (given == std::vector<std::string>{"all"}) return all;
  if (std::find(given.begin(), given.end(), "all") != given.end())
    fail_in_option(option, R"(got "all" together with other names; allowed: "all" alone)");
  std::vector<std::string> valid = all;
  valid.insert(valid.begin(), "all");
  require_names(option, given, valid, shown_by);
  return given;
}

std::vector<std::string> chosen_algorithms(const std::vector<std::string>& given) {
  const std::vector<std::string> known = algorithm_names();
  try {
    return chosen_names("--algorithms", given, known, "hapbench describe algorithms");
  } catch (const InputError& error) {
    const auto is_unlike = [&known](const std::string& name) {
      return name != "all" && std::ranges::count(known, name) == 0 && nearest_name(name, known).empty();
    };
    if (std::ranges::none_of(given, is_unlike)) throw;
    throw InputError(error.kind(), error.location(),
                     error.problem() + "; a law of your own is loaded by --module FILE.so");
  }
}

std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t max_count) {
  if (texts.size() <= max_count) return texts;
  const std::string rest = std::to_string(texts.size() - max_count) + " more like these";
  texts.resize(max_count);
  texts.push_back(rest);
  return texts;
}

}  // namespace hapbench
