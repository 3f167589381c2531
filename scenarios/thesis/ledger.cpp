#include "scenarios/thesis/ledger.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <map>
#include <optional>

namespace hapbench {
namespace {

constexpr const char *kWaiting = "not sampled yet", *kUntouched = "depends on no recorded choice";

std::string text_at(const Json& claim, const char* key) {
  return claim.at(key).get<std::string>();
}

/// The verdict of most samples, if it is not the one on record.
std::optional<std::string> other_majority(const Json& claim) {
  const Json& majority = claim.at("majority");
  if (majority.is_null() || majority == claim.at("verdict")) return std::nullopt;
  return majority.get<std::string>();
}

}  // namespace

Json robustness_on_record(const Json& record, const JudgedClaim& judged) {
  try {
    for (const Json& claim : record.at("claims")) {
      if (claim.at("id") != judged.claim.id) continue;
      const bool same = judged.can_be_sampled() && claim.at("choices") == judged.reach &&
                        claim.at("on_record") == verdict_name(judged.finding.verdict);
      if (!same) break;
      Json counts = claim;
      for (const char* key : {"id", "on_record", "choices"}) counts.erase(key);
      return counts;
    }
    return nullptr;
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("robustness.json: is no record of robustness: {}", problem.what()));
  }
}

Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness) {
  Json claims = Json::array();
  for (const JudgedClaim& j : judged) {
    Json& claim = claims.emplace_back(Json{{"id", j.claim.id},
                                           {"place", j.claim.place},
                                           {"claim", j.claim.claim},
                                           {"published", published.fill(j.claim.published)},
                                           {"measured", j.finding.measured},
                                           {"rule", published.fill(j.claim.rule)},
                                           {"verdict", verdict_name(j.finding.verdict)},
                                           {"robustness", robustness_on_record(robustness, j)},
                                           {"choices_reach_it", !j.reach.empty()},
                                           {"why", j.finding.why},
                                           {"scenarios", j.scenarios},
                                           {"timing", j.claim.timing},
                                           {"ours", j.claim.ours}});
    const Json& counts = claim.at("robustness");
    claim["majority"] = counts.is_null() ? Json() : counts.at("majority");
    claim["sureness"] = robustness_text(claim);
  }
  return {{"headline", ledger_headline(claims)}, {"claims", std::move(claims)}};
}

std::string verdicts_text(const Json& claim) {
  const std::string verdict = text_at(claim, "verdict");
  const std::optional<std::string> majority = other_majority(claim);
  return majority ? fmt::format("most samples: {}; recorded: {}", *majority, verdict) : verdict;
}

std::string robustness_text(const Json& claim) {
  const Json& robustness = claim.at("robustness");
  if (robustness.is_null()) {
    if (claim.at("timing").get<bool>()) return "not sampled: times of one machine";
    if (claim.at("verdict") == verdict_name(Verdict::not_reproducible)) return "not sampled: nothing to simulate";
    return claim.at("choices_reach_it").get<bool>() ? kWaiting : kUntouched;
  }
  const auto judged = robustness.at("judged").get<std::size_t>(), holds = robustness.at("holds").get<std::size_t>();
  std::string text = fmt::format("this verdict in {} of {} samples", holds, judged);
  if (const auto majority = other_majority(claim)) {
    text = fmt::format("{} in {} of {} samples, the recorded verdict in {}", *majority,
                       robustness.at("verdicts").at(*majority).get<std::size_t>(), judged, holds);
  }
  const Json& decided_by = robustness.at("decided_by");
  if (!decided_by.is_null()) {
    text += fmt::format("; decided by {} (S = {:.2f})", text_at(decided_by, "choice"),
                        decided_by.at("index").get<double>());
  } else if (holds < judged) {
    text += "; no single choice decides";
  }
  return text;
}

std::string ledger_headline(const Json& claims) {
  std::size_t all = 0;
  std::map<std::string, std::size_t> count;
  std::string changed;
  for (const Json& claim : claims) {
    if (claim.at("ours").get<bool>()) continue;
    const auto majority = other_majority(claim);
    ++count[majority ? "changes" : claim.at("robustness").is_null() ? robustness_text(claim) : "survives"];
    ++all;
    if (!majority) continue;
    append_item(changed, fmt::format("{} (most samples: {}; recorded: {})", text_at(claim, "id"), *majority,
                                     text_at(claim, "verdict")));
  }
  const std::size_t survive = count["survives"], changes = count["changes"], waiting = count[kWaiting],
                    untouched = count[kUntouched], other = all - survive - changes - waiting - untouched;
  std::string text = fmt::format(
      "Of {} verdicts on claims of the thesis, {} of the {} sampled would survive another reasonable reading: most samples "
      "of the choices on record have them, too. ",
      all, survive, survive + changes);
  if (!changed.empty()) text += fmt::format("{} would not: {}. ", changes, changed);
  text += fmt::format("{} depend on no recorded choice; {} are about times or cannot be simulated", untouched, other);
  return text + (waiting > 0 ? fmt::format("; {} have not been sampled yet.", waiting) : ".");
}

std::string ledger_markdown(const Json& ledger) {
  const std::string heading =
      "| id | place | claim | published | measured | verdict | robustness | why |\n|---|---|---|---|---|---|---|---|\n";
  std::string claims, findings;
  for (const Json& claim : ledger.at("claims")) {
    (claim.at("ours").get<bool>() ? findings : claims) +=
        fmt::format("| {} | {} | {} | {} | {} | **{}** | {} | {} |\n", text_at(claim, "id"), text_at(claim, "place"),
                    text_at(claim, "claim"), text_at(claim, "published"), text_at(claim, "measured"),
                    verdicts_text(claim), robustness_text(claim), text_at(claim, "why"));
  }
  std::string text = text_at(ledger, "headline") + "\n\n" + heading + claims;
  if (!findings.empty()) text += "\nFound on the way, and no claims of the thesis:\n\n" + heading + findings;
  return text;
}

}  // namespace hapbench
