#include "scenarios/thesis/claims.hpp"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <map>

#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

std::vector<Claim> all_claims() {
  // Collect the rules of all chapters by id.
  std::map<std::string, ClaimRule> rules;
  for (const auto chapter :
       {chapters_1_and_4, chapter_3_counts, chapter_3_stiffness, chapter_3_force_limit, chapter_3_trajectory,
        chapter_3_cost, whole_tasks, appendix_a, appendix_b_c_f, appendix_d_experiments})
    for (const ClaimRule& rule : chapter()) rules[rule.id] = rule;
  const std::filesystem::path file = installed_folder("results/reference") / "rules.json";
  const auto text = [](const Json& row, const char* key) { return row.at(key).get<std::string>(); };
  // Read the texts of each claim and add its rule.
  std::vector<Claim> claims;
  try {
    const Json json = read_json(file);
    for (const Json& row : json.at("claims")) {
      Claim& claim = claims.emplace_back(Claim{.id = text(row, "id"),
                                               .location = text(row, "place"),
                                               .claim = text(row, "claim"),
                                               .published = row.value("published", ""),
                                               .rule = text(row, "rule"),
                                               .why = row.value("why", ""),
                                               .measured = row.value("measured", ""),
                                               .each = row.value("each", ""),
                                               .timing = row.value("timing", false),
                                               .ours = row.value("ours", false),
                                               .costly = row.value("costly", false),
                                               .drawn = row.value("drawn", false),
                                               .number = row.value("number", ""),
                                               .published_short = row.value("published_short", ""),
                                               .added = row.value("added", false)});
      if (!claim.why.empty()) continue;  // no simulation can test this claim
      claim.measure = rules.at(claim.id).measure;
      claim.judge = rules.at(claim.id).judge;
      claim.earlier = rules.at(claim.id).earlier;
      if (claim.earlier.judge == nullptr) continue;
      claim.earlier.rule = text(row.at("revised"), "rule");
      claim.earlier.reason = text(row.at("revised"), "reason");
    }
  } catch (const std::exception& problem) {
    fail_in_file(file, fmt::format("is no file of claims, after {} of them: {}", claims.size(), problem.what()));
  }
  return claims;
}

std::vector<AbstractSentence> abstract_sentences() {
  const std::filesystem::path file = installed_folder("results/reference") / "rules.json";
  std::vector<AbstractSentence> sentences;
  try {
    const Json json = read_json(file);
    for (const Json& row : json.at("abstract"))
      sentences.push_back({row.at("sentence").get<std::string>(), row.at("claims").get<std::vector<std::string>>()});
  } catch (const Json::exception& problem) {
    fail_in_file(file, fmt::format("/abstract: {}", problem.what()));
  }
  return sentences;
}

}  // namespace hapbench
