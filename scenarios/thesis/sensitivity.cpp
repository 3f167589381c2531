#include "scenarios/thesis/sensitivity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

constexpr const char* kVerdict = "verdict";  ///< key of the verdict of the present rule
constexpr const char* kEarlier = "earlier";  ///< key of the verdict of the earlier rule

/// Adds the verdicts and the number to the JSON object of a claim or of a case.
void add_finding(Json& json, const SetFinding& found) {
  json[kVerdict] = found.verdict;
  json["number"] = found.number;
  if (!found.earlier.empty()) json[kEarlier] = found.earlier;
}

/// Returns the robustness of the verdict with this key in a claim's entry of the record. See robustness_of().
Robustness robustness_of_verdict(const JudgedClaim& judged, const Json& entry, const char* key) {
  if (judged.claim.timing || judged.finding.verdict == Verdict::not_testable) return {kNotSampledVerdict};
  if (judged.reach.empty()) return {kExactVerdict};
  if (!entry.contains(key)) return {kNotSampledVerdict};  // no entry, or a record of an older version
  std::vector<std::string> deciders;
  for (const Json& one : entry.at("cases")) {
    const std::string verdict = text_at(one, key), assumption = text_at(one, "assumption");
    const bool changes = was_judged(verdict) && verdict != text_at(entry, key);
    if (changes && std::ranges::find(deciders, assumption) == deciders.end()) deciders.push_back(assumption);
  }
  const bool complete = entry.at("cases").size() >= entry.at("complete").get<std::size_t>();
  if (!complete && deciders.size() < 2) return {kNotSampledVerdict};
  const char* word = deciders.empty() ? kRobustVerdict : deciders.size() == 1 ? kSensitiveVerdict : kSeveralVerdict;
  return {word, std::move(deciders)};
}

/// Returns the values of an assumption with which a claim is judged. Empty for a calibrated input, for an assumption
/// that cannot change the claim, and for a claim about computing time or without a judge. Costly claims have the ends
/// of a range only.
std::vector<std::string> values_to_try(const Assumption& assumption, const Claim& claim,
                                       const std::vector<std::string>& scenarios) {
  if (assumption.calibration || claim.timing || claim.judge == nullptr ||
      !assumption.reaches(scenarios, claim.rule_texts()))
    return {};
  return assumption.other_values(!claim.costly);
}

}  // namespace

SensitivityRecord::SensitivityRecord(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return;
  const Json json = with_file(file, [&] { return read_json(file); });
  try {
    for (const Json& claim : json.at("claims")) {
      for (const char* key : {"assumptions", "verdict", "number"}) text_at(claim, key);
      claim.at("complete").get<std::size_t>();
      for (const Json& one : claim.at("cases")) {
        for (const char* key : {"assumption", "value", "verdict", "number"}) text_at(one, key);
        if (claim.contains(kEarlier)) text_at(one, kEarlier);
      }
      claims_[text_at(claim, "id")] = claim;
    }
  } catch (const Json::exception& problem) {
    fail_in_file(file, fmt::format("is no record of sensitivity: {}", problem.what()));
  }
}

Json SensitivityRecord::entry(const std::string& claim, const std::string& reach) const {
  const Json entry = claims_.value(claim, Json());
  return !entry.is_null() && entry.at("assumptions") == reach ? entry : Json();
}

void SensitivityRecord::begin(const std::string& claim, const std::string& reach, const SetFinding& recorded,
                              std::size_t complete) {
  Json made = {{"id", claim}, {"assumptions", reach}, {"complete", complete}, {"cases", Json::array()}};
  add_finding(made, recorded);
  const Json before = entry(claim, reach);
  const auto is_same = [&](const char* key) { return before.value(key, "") == made.value(key, ""); };
  if (!before.is_null() && is_same(kVerdict) && is_same("number") && is_same(kEarlier))
    made["cases"] = before.at("cases");
  claims_[claim] = std::move(made);
}

bool SensitivityRecord::has(const std::string& claim, const std::string& assumption, const std::string& value) const {
  return std::ranges::any_of(claims_.at(claim).at("cases"), [&](const Json& one) {
    return one.at("assumption") == assumption && one.at("value") == value;
  });
}

void SensitivityRecord::add(const std::string& claim, const std::string& assumption, const std::string& value,
                            const SetFinding& found) {
  Json& one = claims_.at(claim)["cases"].emplace_back(Json{{"assumption", assumption}, {"value", value}});
  add_finding(one, found);
}

void SensitivityRecord::sort_cases(const Assumptions& assumptions) {
  // The rank of each case: the index of its assumption, then of its value.
  std::map<std::pair<std::string, std::string>, std::size_t> ranks;
  for (const Assumption& assumption : assumptions.all())
    for (const std::string& value : assumption.other_values())
      ranks.emplace(std::pair(assumption.id, value), ranks.size());
  const auto rank = [&](const Json& one) { return ranks[{text_at(one, "assumption"), text_at(one, "value")}]; };
  for (auto& [id, claim] : claims_.items()) {
    auto cases = claim.at("cases").get<std::vector<Json>>();
    std::ranges::stable_sort(cases, {}, rank);
    claim["cases"] = cases;
  }
}

void SensitivityRecord::keep_only(const std::vector<Claim>& claims) {
  Json kept = Json::object();
  for (const Claim& claim : claims)
    if (claims_.contains(claim.id)) kept[claim.id] = claims_.at(claim.id);
  claims_ = std::move(kept);
}

std::string SensitivityRecord::text() const {
  // One line for each case, so that changes of the record can be read.
  std::string text =
      "{\n  \"about\": \"Verdicts with one assumption at a time at another plausible value; made by hapbench reproduce "
      "--sensitivity.\",\n  \"claims\": [";
  const char* separator = "\n";
  for (const auto& [id, claim] : claims_.items()) {
    Json head = claim;
    head.erase("cases");
    std::string opening = head.dump();
    opening.pop_back();
    text += fmt::format("{}    {}, \"cases\": [", separator, opening);
    const char* comma = "\n";
    for (const Json& one : claim.at("cases")) {
      text += fmt::format("{}      {}", comma, one.dump());
      comma = ",\n";
    }
    text += "]}";
    separator = ",\n";
  }
  return text + "\n  ]\n}\n";
}

bool was_judged(const std::string& verdict) {
  return verdict != kNotMeasured && verdict != verdict_name(Verdict::not_judged);
}

std::string Robustness::text() const {
  if (deciders.empty()) return word;
  return fmt::format("{}{} {}", word, word == kSeveralVerdict ? ":" : "", fmt::join(deciders, ", "));
}

Robustness robustness_of(const JudgedClaim& judged, const Json& entry) {
  return robustness_of_verdict(judged, entry, kVerdict);
}

Robustness earlier_robustness_of(const JudgedClaim& judged, const Json& entry) {
  return robustness_of_verdict(judged, entry, kEarlier);
}

std::size_t case_count(const Assumptions& assumptions, const Claim& claim, const std::vector<std::string>& scenarios) {
  std::size_t count = 0;
  for (const Assumption& assumption : assumptions.all()) count += values_to_try(assumption, claim, scenarios).size();
  return count;
}

std::vector<SensitivityCase> missing_cases(const SensitivityRecord& record, const Assumptions& assumptions,
                                           const std::vector<Claim>& claims,
                                           const std::vector<std::vector<std::string>>& reached) {
  std::vector<SensitivityCase> cases;
  for (const bool costly : {false, true}) {
    for (std::size_t a = 0; a < assumptions.all().size(); ++a) {
      const Assumption& assumption = assumptions.all()[a];
      for (const std::string& value : assumption.other_values()) {
        SensitivityCase one{a, value, {}};
        for (std::size_t c = 0; c < claims.size(); ++c) {
          const std::vector<std::string> values = values_to_try(assumption, claims[c], reached[c]);
          if (claims[c].costly == costly && std::ranges::find(values, value) != values.end() &&
              !record.has(claims[c].id, assumption.id, value))
            one.claims.push_back(claims[c]);
        }
        if (!one.claims.empty()) cases.push_back(std::move(one));
      }
    }
  }
  return cases;
}

}  // namespace hapbench
