#include "scenarios/thesis_claims/ledger.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>

namespace hapbench {

namespace fs = std::filesystem;

namespace {

std::string text_at(const Json& claim, const char* key) {
  return claim.at(key).get<std::string>();
}

/// The verdict that most samples have; of several the one on record, if it is one of them.
std::string majority_of(const ClaimRobustness& claim) {
  std::string majority = claim.on_record;
  std::size_t most = claim.holds;
  for (const auto& [verdict, count] : claim.verdicts) {
    if (count > most) {
      majority = verdict;
      most = count;
    }
  }
  return majority;
}

}  // namespace

Json robustness_json(const RobustnessPlan& plan, const std::vector<JudgedClaim>& judged,
                     const std::vector<ClaimRobustness>& claims, const Json& before) {
  Json entries = Json::array();
  for (std::size_t i = 0; i < claims.size(); ++i) {
    const ClaimRobustness& claim = claims[i];
    Json decided_by = nullptr;
    if (claim.decided_by) decided_by = {{"choice", claim.decided_by->id}, {"index", claim.decided_by->index}};
    entries.push_back({{"id", claim.id},
                       {"choices", judged[i].reach},
                       {"on_record", claim.on_record},
                       {"majority", majority_of(claim)},
                       {"judged", claim.judged},
                       {"holds", claim.holds},
                       {"reproduced", claim.reproduced},
                       {"not_measured", claim.not_measured},
                       {"verdicts", claim.verdicts},
                       {"decided_by", std::move(decided_by)}});
  }
  for (const Json& old : before.value("claims", Json::array())) {
    const auto same = [&old](const ClaimRobustness& claim) { return old.at("id") == claim.id; };
    if (std::none_of(claims.begin(), claims.end(), same)) entries.push_back(old);
  }
  return {{"choices", plan.choices.hash()},
          {"samples", plan.samples()},
          {"costly_samples", plan.costly_samples()},
          {"seed", kRobustnessSeed},
          {"claims", std::move(entries)}};
}

std::string robustness_markdown(const Json& record) {
  std::string text = fmt::format(
      "Every claim judged again at {} points of the ranges of the choices on record (choices.md), a Latin hypercube, the "
      "costly ones at {}. S is the first-order Sobol index of the choice that decides whether the verdict holds.\n\n"
      "| id | verdict on record | of most samples | judged | holds | reproduced | not measured | verdicts | decided by |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      record.at("samples").get<std::size_t>(), record.at("costly_samples").get<std::size_t>());
  for (const Json& claim : record.at("claims")) {
    const auto count = [&claim](const char* key) { return claim.at(key).get<std::size_t>(); };
    std::vector<std::string> verdicts;
    for (const auto& [verdict, samples] : claim.at("verdicts").items())
      verdicts.push_back(fmt::format("{} {}", verdict, samples.get<std::size_t>()));
    std::string decided_by = count("holds") < count("judged") ? "no single choice" : "";
    if (const Json& by = claim.at("decided_by"); !by.is_null())
      decided_by = fmt::format("{} (S = {:.2f})", text_at(by, "choice"), by.at("index").get<double>());
    const bool same = claim.at("majority") == claim.at("on_record");
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", text_at(claim, "id"),
                        text_at(claim, "on_record"), same ? "the same" : "**" + text_at(claim, "majority") + "**",
                        count("judged"), count("holds"), count("reproduced"), count("not_measured"),
                        fmt::join(verdicts, ", "), decided_by);
  }
  return text;
}

RobustnessOnRecord::RobustnessOnRecord(const Json& record) {
  try {
    for (const Json& claim : record.at("claims")) {
      claim.at("majority").get<std::string>();
      claims_[claim.at("id").get<std::string>()] = claim;
    }
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("is no record of robustness: {}", problem.what()));
  }
}

RobustnessOnRecord::RobustnessOnRecord(const fs::path& file) {
  if (!fs::exists(file)) return;
  try {
    *this = RobustnessOnRecord(parse_json(read_text_file(file, kLargestJsonFile)));
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

Json RobustnessOnRecord::of(const JudgedClaim& judged) const {
  const auto found = claims_.find(judged.claim.id);
  if (found == claims_.end() || !judged.can_be_sampled() || found->second.value("choices", "") != judged.reach ||
      found->second.value("on_record", "") != verdict_name(judged.finding.verdict)) {
    return nullptr;
  }
  Json counts = found->second;
  for (const char* key : {"id", "on_record", "choices"}) counts.erase(key);
  return counts;
}

Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                 const RobustnessOnRecord& robustness) {
  Json claims = Json::array();
  for (const JudgedClaim& j : judged) {
    Json& claim = claims.emplace_back(Json{{"id", j.claim.id},
                                           {"place", j.claim.place},
                                           {"claim", j.claim.claim},
                                           {"published", published.fill(j.claim.published)},
                                           {"measured", j.finding.measured},
                                           {"rule", published.fill(j.claim.rule)},
                                           {"verdict", verdict_name(j.finding.verdict)},
                                           {"robustness", robustness.of(j)},
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

namespace {

/// The verdict of most samples, if it is not the one on record.
std::optional<std::string> other_majority(const Json& claim) {
  const Json& majority = claim.at("majority");
  if (majority.is_null() || majority == claim.at("verdict")) return std::nullopt;
  return majority.get<std::string>();
}

}  // namespace

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
    return claim.at("choices_reach_it").get<bool>() ? "not sampled yet" : "depends on no recorded choice";
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
  std::size_t all = 0, survive = 0, changes = 0, untouched = 0, other = 0, waiting = 0;
  std::string changed;
  for (const Json& claim : claims) {
    if (claim.at("ours").get<bool>()) continue;
    ++all;
    const Json& robustness = claim.at("robustness");
    if (const auto majority = other_majority(claim)) {
      ++changes;
      append_item(changed, fmt::format("{} (most samples: {}; recorded: {})", text_at(claim, "id"), *majority,
                                       text_at(claim, "verdict")));
    } else if (!robustness.is_null()) {
      ++survive;
    } else if (claim.at("timing").get<bool>() || claim.at("verdict") == verdict_name(Verdict::not_reproducible)) {
      ++other;
    } else if (claim.at("choices_reach_it").get<bool>()) {
      ++waiting;
    } else {
      ++untouched;
    }
  }
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
