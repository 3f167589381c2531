#include "scenarios/program/tune/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string_view>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/limit/text.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/program/tune/columns.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/diagnosis_advice.hpp"

namespace hapbench {
namespace {

/// Returns the advice `attempt` of a diagnosis with the option of tune in place of the field that tune chooses.
std::string as_options_of_tune(std::string attempt) {
  constexpr std::string_view kOption = "zeta (--damping-ratio)";
  const std::string field = damping_ratio_field();
  for (std::size_t at = attempt.find(field); at != std::string::npos; at = attempt.find(field, at + kOption.size()))
    attempt.replace(at, field.size(), kOption);
  return attempt;
}

std::string limits_text(const Tuning& tuning) {
  std::string text = fmt::format(
      "largest K that the search found{}. All runs at stiffnesses from K to {:g} K are settled: stable or decaying "
      "(\"hapbench describe stability\") or, if a script moves the tool, with little vibration after the first quarter "
      "of the contact (at most 1 mm/s rms above 30 Hz)",
      tuning.ranges.damping_ratio ? ", with damping B = 2 zeta sqrt(K M) and M = rendering.mass_kg" : "",
      tuning.question.margin);
  text += fmt::format(". The run at K does not fail: none of the rules {} applies (\"hapbench describe diagnosis\")",
                      rule_names(RuleKind::failure));
  if (!tuning.question.allow_vibration)
    text += fmt::format(
        ". The runs at K and at {} stiffnesses from {:g} K to K have low vibration: none of the rules {} applies",
        kLowVibrationSamples, kLowVibrationFrom, rule_names(RuleKind::low_vibration));
  for (const auto& [name, bound] : tuning.question.limits) {
    if (bound.min) text += fmt::format(". At K {} >= {:g}", name, *bound.min);
    if (bound.max) text += fmt::format(". At K {} <= {:g}", name, *bound.max);
  }
  const auto range = [](const char* name, const std::optional<Range>& found) {
    return found ? fmt::format(". Range of {}: {:.3g} to {:.3g}", name, found->from, found->to) : "";
  };
  return text + range("zeta", tuning.ranges.damping_ratio) + range("virtual mass [kg]", tuning.ranges.mass);
}

std::string choice_text(const TuneTrial& choice) {
  return fmt::format("K = {} N/m{}", stiffness_text(choice), setting_text(choice.setting));
}

std::string margins_text(const TuneMargins& margins) {
  std::vector<std::string> texts;
  for (const Margin& margin : kMargins)
    if (const auto& found = margins.*margin.of)
      texts.push_back(
          fmt::format(fmt::runtime(margin.text), (*found >= margin.max ? "more than " : "") + significant(*found, 3)));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string recommendation_text(const Tuning& tuning, const Layout& layout) {
  if (tuning.ranking.empty()) return "no stiffness keeps all constraints\n";
  const TunedLaw* best = tuning.ranking[0];
  std::string text = bold(stdout, fmt::format("use {}, {}", best->algorithm, choice_text(*best->choice))) + "\n";
  const auto line = [&](const char* name, const std::string& what) { text += layout.entry(name, what, 2, 14); };
  const bool is_at_end = best->binding == "range";
  line("limited by", fmt::format("{}; {}{}", best->binding, is_at_end ? "" : "with a larger K: ", best->why));
  line("margins", margins_text(best->margins) + "; each is the smallest over all runs");
  if (tuning.ranking.size() > 1) {
    const TunedLaw* next = tuning.ranking[1];
    const std::string factor = significant(next->choice->rendered() / best->choice->rendered(), 2);
    line("runner-up", fmt::format("{}, {}: renders {} stiffness {} {}", next->algorithm, choice_text(*next->choice),
                                  factor == "1" ? "about the same" : factor + " times the", factor == "1" ? "as" : "of",
                                  best->algorithm));
  }
  line("limit of K", fmt::format("without margin{}, with the scenario's own hand: {}",
                                 setting_text(best->choice->setting), limit_answer(best->limits, {})));
  line("verified",
       fmt::format("by {} full-length runs between K and {:g} K, all settled: at most {:.0f} % of this interval may be "
                   "unstable (95 % confidence); {} runs in total",
                   best->verified, tuning.question.margin, 100.0 * may_fail_share(kVerificationSamples), tuning.runs));
  line("diagnosis", best->findings.empty()
                        ? "\"hapbench run\" reports no problem at K"
                        : "at K, \"hapbench run\" reports problems that do not violate a constraint of tune:");
  for (const Diagnosed& found : best->findings)
    line("", fmt::format("{} (rule {}: {}); try: {}, then tune again", found.says, found.rule,
                         value_and_threshold_text(found), as_options_of_tune(found.attempt)));
  line("metrics at K",
       "+-: largest change with half the time step, half the point spacing, or the depth evaluated at every step; "
       "0: no change");
  for (const auto& [name, value] : best->choice->metrics)
    line("", fmt::format("{} {}", name, with_error_text(value, value_in(best->error, name))));
  return text;
}

}  // namespace

void report_tuning(const Tuning& tuning, const Layout& layout, Report& report) {
  report.add_text(layout.wrapped(fmt::format("{}: {}", tuning.scene, limits_text(tuning)), 0) + "\n" +
                  recommendation_text(tuning, layout) + "\n");
  report.show(tuned_columns(tuning.question).table(tuning.laws, tuning.scene, layout.in_full()));
  report.add_text("\n");
  for (const TunedLaw& law : tuning.laws)
    if (!law.choice)
      report.add_text(layout.wrapped(
          fmt::format("{}: no stiffness keeps all constraints: {}; {}", law.algorithm, law.why, law.relax), 0));
}

}  // namespace hapbench
