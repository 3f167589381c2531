#include "scenarios/thesis_claims/claims.hpp"

#include <fmt/format.h>

namespace hapbench {

const VerdictText& text_of(Verdict verdict) {
  // In the order of the enumeration.
  static constexpr VerdictText kTexts[] = {
      {"reproduced", "the rule of the claim holds with the published numbers"},
      {"reproduced in kind", "direction or mechanism are the published ones, the numbers are not"},
      {"not reproduced", "neither, in this model of the device and the hand"},
      {"refuted", "it contradicts an exact result"},
      {"not reproducible", "no simulation can show it: people or the trainer are needed"},
      {"holds", "a finding of ours that the measurement shows"},
      {"does not hold", "a finding of ours that the measurement does not show"}};
  return kTexts[static_cast<std::size_t>(verdict)];
}

Verdict decide(bool reproduced, bool in_kind) {
  return reproduced ? Verdict::reproduced : in_kind ? Verdict::in_kind : Verdict::not_reproduced;
}

void append_item(std::string& list, std::string_view item, std::string_view separator) {
  if (!list.empty()) list += separator;
  list += item;
}

std::string plain(double number) {
  std::string text = fmt::format("{:g}", number);
  // An exponent without its leading zero.
  const auto exponent = text.find("e-0");
  if (exponent != std::string::npos) text.erase(exponent + 2, 1);
  return text;
}

std::vector<Claim> all_claims() {
  std::vector<Claim> claims;
  for (const auto chapter :
       {chapter_3_reduction, chapter_3_cost, chapter_3_stiffness_ratios, chapter_3_force_limit,
        chapter_3_ideal_trajectory, appendix_a, chapter_4_depths, appendix_b_original_algorithm, chapter_4_discussion,
        appendix_c_proposed_algorithm, chapter_1_penetration, appendix_f_optional_algorithms, appendix_d_experiments}) {
    for (Claim& claim : chapter()) claims.push_back(std::move(claim));
  }
  return claims;
}

}  // namespace hapbench
