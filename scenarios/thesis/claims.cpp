#include "scenarios/thesis/claims.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <exception>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include "scenarios/cases/league.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/format/json_file.hpp"

namespace hapbench {

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

Finding Claim::finding(const Evidence& evidence) const {
  if (judge == nullptr) return {Verdict::not_reproducible, "", why};
  const Measured cases = measure(evidence);
  Finding finding = judge(cases, evidence.published);
  PublishedNumbers numbers = evidence.published;
  std::string of_cases;
  for (const MeasuredCase& m : cases) {
    for (const auto& [name, values] : m.values)
      for (const std::string& of_case : {name, m.name + "." + name}) numbers.set(of_case, mean_of(values));
    std::string text = each;
    if (const std::size_t gap = text.find("{}"); gap != std::string::npos) text.replace(gap, 2, m.name);
    if (!each.empty()) append_item(of_cases, numbers.fill(text));
  }
  if (finding.measured.empty()) finding.measured = numbers.fill(measured) + of_cases;
  finding.brief = numbers.fill(main.ours);
  finding.cases = cases;
  return finding;
}

std::vector<Claim> all_claims() {
  std::map<std::string, std::pair<Measure, Judge>> rules;
  for (const auto chapter :
       {chapter_1_penetration, chapter_3_reduction, chapter_3_cost, chapter_3_stiffness_ratios, chapter_3_force_limit,
        chapter_3_ideal_trajectory, chapter_4, appendix_a, appendix_b_original_algorithm, appendix_c_proposed_algorithm,
        appendix_d_experiments, appendix_f_optional_algorithms}) {
    for (const auto& [id, measure, judge] : chapter()) rules[id] = {measure, judge};
  }
  const std::filesystem::path file = installed_folder("results/reference") / "rules.json";
  std::vector<Claim> claims;
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    for (const Json& row : json.at("claims")) {
      claims.push_back({.id = row.at("id"),
                        .place = row.at("place"),
                        .claim = row.at("claim"),
                        .published = row.value("published", ""),
                        .rule = row.at("rule"),
                        .why = row.value("why", ""),
                        .measured = row.value("measured", ""),
                        .each = row.value("each", ""),
                        .timing = row.value("timing", false),
                        .ours = row.value("ours", false),
                        .costly = row.value("costly", false),
                        .drawn = row.value("drawn", false)});
      Claim& claim = claims.back();
      if (const Json main = row.value("main", Json()); !main.is_null())
        claim.main = {main.at("claim"), main.at("published"), main.at("ours")};
      if (claim.why.empty()) std::tie(claim.measure, claim.judge) = rules.at(claim.id);
    }
  } catch (const std::exception& problem) {
    fail_in_file(file, fmt::format("is no file of claims, after {} of them: {}", claims.size(), problem.what()));
  }
  return claims;
}

}  // namespace hapbench
