#include "scenarios/program/tune/question.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/tuning/scene_variants.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/chosen_devices.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/option_values.hpp"

namespace hapbench {
namespace {

/// Parses a range of numbers above 0. Successive values of the search in this range have equal ratios. Returns empty
/// for an empty text. Throws InputError.
std::optional<Range> parse_ratio_range(const char* option, const std::string& text) {
  std::optional<Range> range = parse_range(option, text);
  if (!range) return range;
  if (!(range->from > 0.0)) fail_in_option(option, fmt::format("got \"{}\"; allowed: a:b with 0 < a < b", text));
  range->logarithmic = true;
  return range;
}

}  // namespace

TuneQuestion tune_question(const TuneOptions& options, const std::filesystem::path& file) {
  TuneQuestion question = options.question;
  question.scenario = read_scenario_text(file);
  question.overrides = options.overrides;
  if (!(question.margin > 1.0 && question.margin <= 16.0))
    fail_in_option("--margin", fmt::format("got {}; allowed: more than 1, at most 16", question.margin));
  for (const std::string& bound : options.bounds) add_bound(bound, question.limits);
  if (!options.family.empty())
    question.families = chosen_names("--family", options.family, {std::begin(kFamilies), std::end(kFamilies)});
  if (const auto range = parse_ratio_range("--damping-ratio", options.damping_ratio)) question.damping_ratio = *range;
  question.mass = parse_ratio_range("--mass", options.mass);
  question.threads = threads_of(options);
  return question;
}

std::string device_text(const std::string& name, TuneQuestion& question) {
  if (name.empty()) return "";
  const std::vector<ComparedDevice> devices = chosen_devices({name});
  if (devices.size() != 1)
    fail_in_option("--device", fmt::format("got \"{}\"; allowed: one device, a preset or a file NAME.json", name));
  const ComparedDevice& device = devices.front();
  question.overrides = overrides_on(device, question.scenario, question.overrides);
  return " on " + device.name;
}

}  // namespace hapbench
