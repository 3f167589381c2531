#include "scenarios/thesis/ledger.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

namespace {

constexpr const char *kSteady = "steady", *kFragile = "fragile", *kNotSampled = "not sampled";

std::string text_at(const Json& claim, const char* key) {
  return claim.at(key).get<std::string>();
}

bool is_ours(const Json& claim) {
  return claim.at("ours").get<bool>();
}

/// Returns the robustness of a verdict: "steady" if more than half of the judged samples of the choices give the
/// recorded verdict, otherwise "fragile"; "not sampled" without samples.
const char* sureness(const Json& robustness) {
  if (robustness.is_null()) return kNotSampled;
  const auto judged = robustness.at("judged").get<std::size_t>(), holds = robustness.at("holds").get<std::size_t>();
  return 2 * holds > judged ? kSteady : kFragile;
}

/// Returns the verdict of a claim in claims.json.
Verdict verdict_of(const Json& claim) {
  const auto* found = std::ranges::find(kVerdicts, text_at(claim, "verdict"), &VerdictText::name);
  return static_cast<Verdict>(found - std::begin(kVerdicts));
}

/// Returns the text, cut at a word boundary to at most `most` characters and an ellipsis if it is longer.
std::string shortened(const std::string& text, std::size_t most) {
  if (count_characters(text) <= most) return text;
  std::size_t end = 0;
  for (std::size_t i = 0, seen = 0; i < text.size() && seen < most; ++i) {
    if (starts_character(text[i])) ++seen;
    if (text[i] == ' ') end = i;
  }
  return text.substr(0, text.find_last_not_of(" ,;:", end) + 1) + " …";
}

/// Returns the chapter or appendix of a claim's first numbered section, such as "C" for "abstract, C.2".
std::string chapter_of(const Json& claim) {
  const std::string place = text_at(claim, "place");
  const std::size_t number = place.find_first_of("0123456789");
  const bool appendix = number >= 2 && place[number - 1] == '.';
  return std::string(1, place.at(appendix ? number - 2 : number));
}

/// Returns a line for each chapter, with a symbol for each of its claims.
std::string chapter_bars(const Json& claims) {
  std::map<std::string, std::array<std::string, std::size(kVerdicts)>> chapters;
  for (const Json& claim : claims) {
    const auto verdict = static_cast<std::size_t>(verdict_of(claim));
    if (!is_ours(claim)) chapters[chapter_of(claim)][verdict] += kVerdicts[verdict].mark;
  }
  std::string text;
  for (const auto& [chapter, marks] : chapters) text += fmt::format("    {}  {}\n", chapter, fmt::join(marks, ""));
  return text;
}

/// Returns the heading of a table. `columns`: names of its first two columns.
std::string heading(const char* columns) {
  return fmt::format(
      "| {} | published | ours | verdict | sureness | command | seconds |\n|---|---|---|---|---|---|---|---|\n",
      columns);
}

/// Returns the last cells of a table row: verdict, sureness, command and seconds.
std::string last_cells(const Json& claim) {
  const double seconds = claim.at("seconds").get<double>();
  return fmt::format(" | {} | {} | `{}` | {} |", text_at(claim, "verdict"), text_at(claim, "sureness"),
                     text_at(claim, "command"), seconds < 1.0 ? "< 1" : fmt::format("{:.0f}", seconds));
}

/// Returns the table of the main results.
std::string main_results(const Json& claims) {
  std::string text = heading("claim | place");
  for (const Json& claim : claims) {
    if (!claim.contains("main")) continue;
    const Json& main = claim.at("main");
    text += fmt::format("| {} | {} | {} | {}{}\n", text_at(main, "claim"), text_at(claim, "place"),
                        text_at(main, "published"), text_at(main, "ours"), last_cells(claim));
  }
  return text;
}

/// Returns the table row of a claim, with texts shortened to at most 300 characters in total.
std::string row_of(const Json& claim) {
  constexpr std::size_t kClaim = 90, kPublished = 50,
                        kLongestRow = 300;  // [characters]; `describe ID` prints the full texts
  const std::string before =
      fmt::format("| {} | {} | {} | ", text_at(claim, "id"), shortened(text_at(claim, "claim"), kClaim),
                  shortened(text_at(claim, "published"), kPublished));
  const std::string after = last_cells(claim);
  const std::size_t ellipsis = 2, room = kLongestRow - count_characters(before + after) - ellipsis;
  return before + shortened(text_at(claim, "measured"), room) + after + "\n";
}

/// Returns the numbers of each case; a list if a name has several numbers.
Json cases_json(const Measured& cases) {
  Json json = Json::array();
  for (const MeasuredCase& m : cases) {
    Json& values = json.emplace_back(Json{{"name", m.name}})["values"];
    for (const auto& [name, all] : m.values) values[name] = all.size() == 1 ? Json(all.front()) : Json(all);
  }
  return json;
}

/// Returns the entry of a claim in robustness.json; null if there is none for this verdict and these choices. Throws
/// InputError if the file has another format.
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

}  // namespace

std::string headline_of(const Json& claims) {
  // Count the verdicts, and the robustness of the verdicts, over the claims of the thesis.
  std::map<Verdict, std::size_t> verdicts;
  std::map<std::string, std::size_t> sure;
  std::size_t all = 0;
  for (const Json& claim : claims) {
    if (is_ours(claim)) continue;
    ++all;
    ++verdicts[verdict_of(claim)];
    ++sure[text_at(claim, "sureness")];
  }
  std::string counts;
  for (const auto& [verdict, count] : verdicts)
    append_item(counts, fmt::format("{} {}", count, verdict_name(verdict)), ", ");
  return fmt::format(
      "{} claims of the thesis: {}. {} of the verdicts are steady (more than half of the samples of the choices on "
      "record have them), {} fragile, {} not sampled.",
      all, counts, sure[kSteady], sure[kFragile], sure[kNotSampled]);
}

Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published, const Json& robustness) {
  Json claims = Json::array();
  for (const JudgedClaim& j : judged) {
    Json counts = robustness_on_record(robustness, j);
    const char* sure = sureness(counts);
    Json& claim = claims.emplace_back(Json{{"id", j.claim.id},
                                           {"place", j.claim.place},
                                           {"claim", j.claim.claim},
                                           {"published", published.fill(j.claim.published)},
                                           {"measured", j.finding.measured},
                                           {"rule", published.fill(j.claim.rule)},
                                           {"verdict", verdict_name(j.finding.verdict)},
                                           {"sureness", sure},
                                           {"robustness", std::move(counts)},
                                           {"choices_reach_it", !j.reach.empty()},
                                           {"why", j.finding.why},
                                           {"scenarios", j.scenarios},
                                           {"command", "hapbench reproduce --only " + j.claim.id},
                                           {"seconds", std::round(10.0 * j.seconds) / 10.0},
                                           {"timing", j.claim.timing},
                                           {"ours", j.claim.ours}});
    if (j.claim.drawn) claim["cases"] = cases_json(j.finding.cases);
    if (!j.claim.main.claim.empty()) {
      claim["main"] = {{"claim", j.claim.main.claim},
                       {"published", published.fill(j.claim.main.published)},
                       {"ours", j.finding.brief}};
    }
  }
  return {{"headline", headline_of(claims)}, {"claims", std::move(claims)}};
}

std::string ledger_markdown(const Json& ledger) {
  const Json& claims = ledger.at("claims");
  // Main results, headline, bars by chapter and the meanings of the verdicts.
  std::string text =
      main_results(claims) + "\n" + text_at(ledger, "headline") + " By chapter:\n\n" + chapter_bars(claims) + "\n";
  for (std::size_t v = 0; v <= static_cast<std::size_t>(Verdict::not_reproducible); ++v)
    text += fmt::format("{} *{}*: {}.  \n", kVerdicts[v].mark, kVerdicts[v].name, kVerdicts[v].meaning);
  // Table of all claims, contradicted claims first.
  text += "\nMore of a row: `hapbench describe ID`.\n\n" + heading("id | claim");
  for (const Verdict verdict : {Verdict::refuted, Verdict::not_reproduced, Verdict::in_kind, Verdict::reproduced})
    for (const Json& claim : claims)
      if (!is_ours(claim) && verdict_of(claim) == verdict) text += row_of(claim);
  // List the claims that no simulation can test, and the findings of this project.
  std::string unjudged, findings;
  for (const Json& claim : claims) {
    if (is_ours(claim)) findings += row_of(claim);
    if (verdict_of(claim) != Verdict::not_reproducible) continue;
    unjudged += fmt::format("- {}, {}: {}.\n", text_at(claim, "id"), text_at(claim, "claim"), text_at(claim, "why"));
  }
  if (!unjudged.empty()) text += "\nWhat cannot be judged:\n\n" + unjudged;
  if (!findings.empty())
    text += "\nFound on the way, and no claims of the thesis:\n\n" + heading("id | claim") + findings;
  return text;
}

}  // namespace hapbench
