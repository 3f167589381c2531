#include "scenarios/thesis_claims/ledger.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace hapbench {

namespace fs = std::filesystem;

Json robustness_json(const RobustnessPlan& plan, const std::vector<ClaimRobustness>& claims) {
  Json entries = Json::array();
  for (const ClaimRobustness& claim : claims) {
    Json decided_by = nullptr;
    if (claim.decided_by) decided_by = {{"choice", claim.decided_by->id}, {"index", claim.decided_by->index}};
    entries.push_back({{"id", claim.id},
                       {"on_record", claim.on_record},
                       {"judged", claim.judged},
                       {"holds", claim.holds},
                       {"reproduced", claim.reproduced},
                       {"not_measured", claim.not_measured},
                       {"verdicts", claim.verdicts},
                       {"decided_by", std::move(decided_by)}});
  }
  return {{"choices", plan.choices.hash()},
          {"samples", plan.samples()},
          {"costly_samples", plan.costly_samples()},
          {"seed", kRobustnessSeed},
          {"claims", std::move(entries)}};
}

std::string robustness_markdown(const RobustnessPlan& plan, const std::vector<ClaimRobustness>& claims) {
  std::string text = fmt::format(
      "Every claim judged again at {} points of the ranges of the choices on record (choices.md), a Latin hypercube, the "
      "costly ones at {}. S is the first-order Sobol index of the choice that decides whether the verdict holds.\n\n"
      "| id | verdict on record | judged | holds | reproduced | not measured | verdicts | decided by |\n"
      "|---|---|---|---|---|---|---|---|\n",
      plan.samples(), plan.costly_samples());
  for (const ClaimRobustness& claim : claims) {
    std::vector<std::string> verdicts;
    for (const auto& [verdict, count] : claim.verdicts) verdicts.push_back(fmt::format("{} {}", verdict, count));
    std::string decided_by = claim.holds < claim.judged ? "no single choice" : "";
    if (claim.decided_by) decided_by = fmt::format("{} (S = {:.2f})", claim.decided_by->id, claim.decided_by->index);
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", claim.id, claim.on_record, claim.judged,
                        claim.holds, claim.reproduced, claim.not_measured, fmt::join(verdicts, ", "), decided_by);
  }
  return text;
}

RobustnessOnRecord::RobustnessOnRecord(const Json& record, const std::string& choices_hash) {
  try {
    if (record.at("choices") != choices_hash) return;
    for (const Json& claim : record.at("claims")) claims_[claim.at("id").get<std::string>()] = claim;
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("is no record of robustness: {}", problem.what()));
  }
}

RobustnessOnRecord::RobustnessOnRecord(const fs::path& file, const std::string& choices_hash) {
  if (!fs::exists(file)) return;
  try {
    *this = RobustnessOnRecord(parse_json(read_text_file(file, kLargestJsonFile)), choices_hash);
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

Json RobustnessOnRecord::of(const JudgedClaim& judged) const {
  const auto found = claims_.find(judged.claim.id);
  if (found == claims_.end() || found->second.value("on_record", "") != verdict_name(judged.finding.verdict)) {
    return nullptr;
  }
  Json counts = found->second;
  counts.erase("id");
  counts.erase("on_record");
  return counts;
}

std::string robustness_text(const Json& robustness) {
  if (robustness.is_null()) return "";
  const auto judged = robustness.at("judged").get<std::size_t>(), holds = robustness.at("holds").get<std::size_t>();
  std::string text = fmt::format("this verdict in {} of {} samples", holds, judged);
  const Json& decided_by = robustness.at("decided_by");
  if (!decided_by.is_null()) {
    text += fmt::format("; decided by {} (S = {:.2f})", decided_by.at("choice").get<std::string>(),
                        decided_by.at("index").get<double>());
  } else if (holds < judged) {
    text += "; no single choice decides";
  }
  return text;
}

Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                 const RobustnessOnRecord& robustness) {
  Json claims = Json::array();
  for (const JudgedClaim& j : judged) {
    claims.push_back({{"id", j.claim.id},
                      {"place", j.claim.place},
                      {"claim", j.claim.claim},
                      {"published", published.fill(j.claim.published)},
                      {"measured", j.finding.measured},
                      {"rule", published.fill(j.claim.rule)},
                      {"verdict", verdict_name(j.finding.verdict)},
                      {"robustness", robustness.of(j)},
                      {"why", j.finding.why},
                      {"scenarios", j.scenarios},
                      {"timing", j.claim.timing}});
  }
  return {{"claims", std::move(claims)}};
}

namespace {

/// The cell of a claim: its counts, or the reason why it has none.
std::string robustness_cell(const JudgedClaim& judged, const RobustnessOnRecord& robustness) {
  if (judged.claim.timing) return "not sampled: times of one machine";
  if (judged.finding.verdict == Verdict::not_reproducible) return "not sampled: nothing to simulate";
  return robustness_text(robustness.of(judged));
}

}  // namespace

std::string ledger_markdown(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                            const RobustnessOnRecord& robustness) {
  std::string text =
      "| id | place | claim | published | measured | verdict | robustness | why |\n|---|---|---|---|---|---|---|---|\n";
  for (const JudgedClaim& j : judged) {
    text += fmt::format("| {} | {} | {} | {} | {} | **{}** | {} | {} |\n", j.claim.id, j.claim.place, j.claim.claim,
                        published.fill(j.claim.published), j.finding.measured, verdict_name(j.finding.verdict),
                        robustness_cell(j, robustness), j.finding.why);
  }
  return text;
}

}  // namespace hapbench
