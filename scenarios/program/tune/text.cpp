#include "scenarios/program/tune/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <vector>

#include "scenarios/program/digits.hpp"
#include "scenarios/program/limit/text.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/program/tune/columns.hpp"

namespace hapbench {
namespace {

std::string limits_text(const Tuning& tuning) {
  std::string text = fmt::format("largest K that is settled up to {:g} K{}", tuning.question.margin,
                                 tuning.ranges.damping_ratio ? ", with B = 2 zeta sqrt(K m) at each" : "");
  if (tuning.question.limits.empty())
    text += ", in a run that is quiet (describe diagnosis: buzz, pop, chatter, energy)";
  for (const auto& [name, bound] : tuning.question.limits) {
    if (bound.min) text += fmt::format(", {} >= {:g}", name, *bound.min);
    if (bound.max) text += fmt::format(", {} <= {:g}", name, *bound.max);
  }
  const auto range = [](const char* name, const std::optional<Range>& found) {
    return found ? fmt::format("; {} {:.3g} ... {:.3g}", name, found->from, found->to) : "";
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
          fmt::format(fmt::runtime(margin.words), (*found >= margin.most ? "over " : "") + significant(*found, 3)));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string recommendation_text(const Tuning& tuning, const Layout& layout) {
  if (tuning.ranking.empty()) return "nothing is feasible\n";
  const TunedLaw* best = tuning.ranking[0];
  std::string text = bold(stdout, fmt::format("use {}, {}", best->algorithm, choice_text(*best->choice))) + "\n";
  const auto line = [&](const char* name, const std::string& what) { text += layout.entry(name, what, 2, 14); };
  line("stops at", fmt::format("{}: {}", best->binding, best->why));
  line("margins", margins_text(best->margins));
  if (tuning.ranking.size() > 1) {
    const TunedLaw* next = tuning.ranking[1];
    line("runner-up",
         fmt::format("{}, {}: {} times the rendered stiffness", next->algorithm, choice_text(*next->choice),
                     significant(next->choice->rendered() / best->choice->rendered(), 2)));
  }
  line("K's edges", limit_answer(best->edge, kEdgeResolution));
  line("verified",
       fmt::format("by {} full-length runs between K and {:g} K, all settled: at most {:.0f} % of what lies "
                   "between may not be (95 %); {} runs in all",
                   best->verified, tuning.question.margin, 100.0 * may_fail_share(kTriedBetween), tuning.runs));
  line("expect", "+-: how far half the step, half the distance of the points or a look at every row move it");
  for (const auto& [name, value] : best->choice->metrics)
    line("", fmt::format("{} {}", name, with_error_text(value, value_in(best->error, name))));
  return text;
}

}  // namespace

std::string tuning_text(const Tuning& tuning, const Layout& layout) {
  std::string text = layout.wrapped(fmt::format("{}: {}", tuning.scene, limits_text(tuning)), 0) + "\n" +
                     recommendation_text(tuning, layout) + "\n" + tuned_columns().text(tuning.laws, layout) + "\n";
  for (const TunedLaw& law : tuning.laws)
    if (!law.choice)
      text += layout.wrapped(fmt::format("{}: nothing is feasible, {}; {}", law.algorithm, law.why, law.relax), 0);
  return text;
}

}  // namespace hapbench
