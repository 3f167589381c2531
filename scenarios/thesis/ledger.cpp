#include "scenarios/thesis/ledger.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/claims.hpp"

namespace hapbench {

namespace {

bool is(const Json& claim, const char* key) {
  return claim.at(key).get<bool>();
}

/// Returns the verdict of a claim in claims.json.
Verdict verdict_of(const Json& claim) {
  const auto* found = std::ranges::find(kVerdicts, text_at(claim, "verdict"), &VerdictText::name);
  return static_cast<Verdict>(found - std::begin(kVerdicts));
}

bool failed(const Json& claim) {
  const Verdict verdict = verdict_of(claim);
  return verdict == Verdict::not_replicated || verdict == Verdict::contradicted || verdict == Verdict::not_consistent ||
         verdict == Verdict::not_judged;
}

/// Returns the first figure that a location in the thesis names, such as "Fig. A.2"; empty if it names none.
std::string figure_of(const std::string& location) {
  static const std::regex kFigure(R"(Fig\. ((?:[A-F]\.)?\d+))");
  std::smatch found;
  return std::regex_search(location, found, kFigure) ? found[0].str() : "";
}

/// Returns the chapter or appendix of a claim's first numbered section, such as "C" for "abstract, C.2".
std::string chapter_of(const Json& claim) {
  const std::string location = text_at(claim, "place");
  const std::size_t number = location.find_first_of("0123456789");
  const bool appendix = number >= 2 && location[number - 1] == '.';
  return std::string(1, location.at(appendix ? number - 2 : number));
}

std::string link_to(const Json& claim) {
  const std::string id = text_at(claim, "id");
  return fmt::format("[{}](claim_pages.md#{})", id, lower_case(id));
}

/// Returns the robustness of a claim as Markdown with the names of assumptions in code style, such as "sensitive to
/// `local.average`". Names the first `max_names` assumptions and counts the others.
std::string robustness_text(const Json& claim, std::size_t max_names) {
  auto deciders = claim.at("deciders").get<std::vector<std::string>>();
  if (deciders.empty()) return text_at(claim, "robustness");
  const std::size_t count = deciders.size();
  if (count > max_names) deciders.resize(max_names);
  return fmt::format("{}{} `{}`{}", count == 1 ? kSensitiveVerdict : kSeveralVerdict, count == 1 ? "" : ":",
                     fmt::join(deciders, "`, `"),
                     count > max_names ? fmt::format(" and {} more", count - max_names) : "");
}

std::string robustness_text(const Json& claim) {
  return robustness_text(claim, std::numeric_limits<std::size_t>::max());
}

std::string seconds_text(const Json& claim) {
  const double seconds = claim.at("seconds").get<double>();
  return seconds < 1.0 ? "< 1 s" : fmt::format("{:.0f} s", seconds);
}

/// Returns the measured number that decides a claim, as text for a table; a dash for a claim without such a number.
std::string ours(const Json& claim) {
  const std::string number = text_at(claim, "number");
  return number.empty() ? "–" : number;
}

constexpr const char* kHeading =
    "| id | claim | published | ours | verdict | robustness |\n|---|---|---|---|---|---|\n";

std::string row_of(const Json& claim) {
  return fmt::format("| {} | {} | {} | {} | {} | {} |\n", link_to(claim), text_at(claim, "claim"),
                     text_at(claim, "published"), ours(claim), text_at(claim, "verdict"), robustness_text(claim));
}

/// Returns a cell of the abstract's table: the text of each claim, after its id if there are several claims.
std::string joined(const std::vector<const Json*>& claims, const std::function<std::string(const Json&)>& text) {
  std::string cell;
  for (const Json* claim : claims)
    append_item(cell, (claims.size() > 1 ? text_at(*claim, "id") + ": " : "") + text(*claim), "<br>");
  return cell;
}

/// Returns the table of the abstract's sentences.
std::string abstract_table(const Json& ledger) {
  std::string text =
      "| claim of the abstract | published | ours | verdict | robustness | figure | command |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Json& sentence : ledger.at("abstract")) {
    std::vector<const Json*> claims;
    std::string ids, figure;
    double seconds = 0.0;
    for (const Json& id : sentence.at("claims"))
      for (const Json& claim : ledger.at("claims"))
        if (claim.at("id") == id) {
          claims.push_back(&claim);
          append_item(ids, id.get<std::string>(), ",");
          if (figure.empty()) figure = text_at(claim, "figure");
          seconds += claim.at("seconds").get<double>();
        }
    if (claims.empty()) continue;         // a run with --only may not have judged the claim
    constexpr std::size_t kMaxNames = 2;  // the page of the claim names all assumptions
    const auto deciders = [](const Json& claim) { return robustness_text(claim, kMaxNames); };
    const auto member = [](const char* key) { return [key](const Json& claim) { return text_at(claim, key); }; };
    text += fmt::format("| {} | {} | {} | {} | {} | {} | `hapbench reproduce --only {}` ({:.0f} s) |\n",
                        text_at(sentence, "sentence"), joined(claims, member("published_short")), joined(claims, ours),
                        joined(claims, member("verdict")), joined(claims, deciders), figure, ids, std::ceil(seconds));
  }
  return text;
}

/// Returns the claims that failed, with the reason and the assumptions that decide the verdict.
std::string failures(const Json& claims) {
  std::string text;
  for (const Json& claim : claims) {
    if (is(claim, "ours") || is(claim, "timing") || !failed(claim)) continue;
    text += fmt::format("- {}, {} ({}): *{}*; measured: {}; {}. Why: {}.\n", link_to(claim), text_at(claim, "claim"),
                        text_at(claim, "place"), text_at(claim, "verdict"), ours(claim), robustness_text(claim),
                        text_at(claim, "why"));
  }
  return text;
}

/// Stands above the table of appendix D.
constexpr const char* kAboveExperiments =
    "For D1 to D4, the column *ours* shows the success rates. It shows another measure only if that other measure does "
    "not agree with the claim; the claim pages show all. The measured force is not judged, because the simulated "
    "subjects regulate it.\n\n";

/// Returns a table of claims for each chapter.
std::string chapters(const Json& claims) {
  std::map<std::string, std::string> tables;
  for (const Json& claim : claims)
    if (!is(claim, "ours") && !is(claim, "timing") && verdict_of(claim) != Verdict::not_testable)
      tables[chapter_of(claim)] += row_of(claim);
  std::string text;
  for (const auto& [chapter, rows] : tables)
    text += fmt::format("\n### {} {}\n\n{}{}{}",
                        std::isdigit(static_cast<unsigned char>(chapter[0])) ? "Chapter" : "Appendix", chapter,
                        chapter == "D" ? kAboveExperiments : "", kHeading, rows);
  return text;
}

/// Returns a table of the claims that fulfil a condition; empty without such claims.
std::string table_of(const Json& claims, const std::string& title, bool (*belongs)(const Json&)) {
  std::string rows;
  for (const Json& claim : claims)
    if (belongs(claim)) rows += row_of(claim);
  return rows.empty() ? "" : fmt::format("\n### {}\n\n{}{}", title, kHeading, rows);
}

/// Cell of the verdict by the present rule if it is the verdict by the earlier rule.
constexpr std::string_view kUnchanged = "the same";

/// Returns a table of the claims whose rules were changed, with a row for each pair of verdicts: first the rows whose
/// verdicts differ. claim_pages() prints the earlier rules and the reasons. Empty if no rule was changed.
std::string changed_rules(const Json& claims) {
  using Row = std::pair<std::string, std::string>;  // cells of both verdicts, cell of the claims
  std::vector<Row> rows;
  for (const Json& claim : claims) {
    if (!claim.contains("revised")) continue;
    const std::string before = text_at(claim.at("revised"), "verdict"), now = text_at(claim, "verdict");
    const std::string verdicts = fmt::format("{} | {}", before, before == now ? kUnchanged : now);
    auto row = std::ranges::find(rows, verdicts, &Row::first);
    if (row == rows.end()) row = rows.insert(row, {verdicts, ""});
    append_item(row->second, link_to(claim), ", ");
  }
  if (rows.empty()) return "";
  // clang 14 cannot compile std::ranges::stable_partition() with the standard library of GCC 12.
  std::stable_partition(rows.begin(), rows.end(), [](const Row& row) { return !row.first.ends_with(kUnchanged); });
  std::string text =
      "\n### Rules that were changed after their verdicts were known\n\nThe claim pages have the earlier rule, the "
      "present rule and the reason of the change. Both rules were applied to the same runs, except in J1, whose "
      "earlier rule needs runs with other hands.\n\n| verdict by the earlier rule | verdict by the present rule | "
      "claims |\n|---|---|---|\n";
  for (const auto& [verdicts, links] : rows) text += fmt::format("| {} | {} |\n", verdicts, links);
  return text;
}

/// Returns the claims whose present rules were fixed before the measurement (Claim::added), with a heading.
std::string rules_before_measurement(const Json& claims) {
  std::string added;
  for (const Json& claim : claims)
    if (is(claim, "added") && !claim.contains("revised")) append_item(added, link_to(claim), ", ");
  if (added.empty()) return "";
  return fmt::format(
      "\n### Rules that were fixed before the measurement\n\nThe rules of these claims were fixed before hapbench "
      "measured the claims ([details](../../scenarios/thesis/README.md#rules-of-new-claims)): {}. For other "
      "claims, it is not recorded whether the rule or the measurement came first.\n",
      added);
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

/// Adds to a JSON object that has a verdict the robustness of this verdict and the assumptions that decide it.
void add_robustness(Json& json, const Robustness& robustness) {
  json["robustness"] = robustness.text();
  json["deciders"] = robustness.deciders;
}

/// Returns the earlier rule of a claim: its text, its verdict with robustness, and why it was changed.
Json earlier_json(const JudgedClaim& judged, const PublishedNumbers& published, const SensitivityRecord& record) {
  const EarlierRule& rule = judged.claim.earlier;
  const Json entry = record.entry(judged.claim.id, judged.reach);
  Json json = {{"rule", published.fill(rule.rule)},
               {"verdict", verdict_name(judged.finding.earlier.value())},
               {"reason", rule.reason}};
  add_robustness(json, earlier_robustness_of(judged, entry));
  return json;
}

/// Adds to the JSON object of a claim the robustness of its verdict, the assumptions that decide the verdict, and from
/// the record of sensitivity the number of cases and the cases with another verdict.
void add_sensitivity(Json& claim, const JudgedClaim& judged, const SensitivityRecord& record) {
  const Json entry = record.entry(judged.claim.id, judged.reach);
  const Robustness robustness = robustness_of(judged, entry);
  add_robustness(claim, robustness);
  Json moved = Json::array();
  std::size_t tried = 0;
  if (!entry.is_null() && robustness.word != kNotSampledVerdict) {
    tried = entry.at("cases").size();
    for (const Json& one : entry.at("cases"))
      if (one.at("verdict") != entry.at("verdict")) moved.push_back(one);
  }
  claim["cases_tried"] = tried;
  claim["cases_moved"] = std::move(moved);
}

}  // namespace

std::string headline_of(const Json& claims) {
  // Count the verdicts, and the robustness of the verdicts, over the claims of the thesis.
  std::map<Verdict, std::size_t> verdicts;
  std::map<std::string, std::size_t> sure;
  std::size_t all = 0, timing = 0;
  for (const Json& claim : claims) {
    if (is(claim, "ours")) continue;
    if (is(claim, "timing")) {
      ++timing;
      continue;
    }
    ++all;
    ++verdicts[verdict_of(claim)];
    if (verdict_of(claim) == Verdict::not_testable) continue;  // no assumption can change this verdict
    const std::size_t deciders = claim.at("deciders").size();
    ++sure[deciders == 0 ? text_at(claim, "robustness") : deciders == 1 ? kSensitiveVerdict : kSeveralVerdict];
  }
  std::string counts;
  for (const auto& [verdict, count] : verdicts)
    append_item(counts, fmt::format("{} {}", count, verdict_name(verdict)), ", ");
  const std::size_t testable = all - verdicts[Verdict::not_testable];
  std::string text = timing == 0 ? fmt::format("Verdicts on the {} claims of the thesis", all)
                                 : fmt::format(
                                       "The thesis has {} claims. Verdicts on the {} claims that are not about "
                                       "computing time",
                                       all + timing, all);
  text += fmt::format(
      ": {}. {} of these {} claims are testable. Of their verdicts, {} are exact (no assumption enters), {} are robust "
      "(no single assumption changes them), {} are sensitive to one assumption, {} depend on several assumptions",
      counts, testable, all, sure[kExactVerdict], sure[kRobustVerdict], sure[kSensitiveVerdict], sure[kSeveralVerdict]);
  const std::size_t others = sure[kNotSampledVerdict];
  if (others > 0) text += fmt::format(", {} were not sampled (no other values were tried)", others);
  text += ".";
  if (timing > 0)
    text += fmt::format(
        " Verdicts on the {} claims about computing time are not counted, because times depend on the machine.",
        timing);
  return text;
}

Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                 const SensitivityRecord& record) {
  Json claims = Json::array();
  for (const JudgedClaim& j : judged) {
    const std::string full = published.fill(j.claim.published);
    Json& claim = claims.emplace_back(
        Json{{"id", j.claim.id},
             {"place", j.claim.location},
             {"claim", j.claim.claim},
             {"published", full},
             {"published_short", j.claim.published_short.empty() ? full : published.fill(j.claim.published_short)},
             {"number", j.finding.number},
             {"measured", j.finding.measured},
             {"rule", published.fill(j.claim.rule)},
             {"verdict", verdict_name(j.finding.verdict)},
             {"why", j.finding.why},
             {"figure", figure_of(j.claim.location)},
             {"scenarios", j.scenarios},
             {"command", "hapbench reproduce --only " + j.claim.id},
             {"seconds", std::round(10.0 * j.seconds) / 10.0},
             {"timing", j.claim.timing},
             {"ours", j.claim.ours},
             {"added", j.claim.added}});
    add_sensitivity(claim, j, record);
    if (j.finding.earlier) claim["revised"] = earlier_json(j, published, record);
    if (j.claim.drawn) claim["cases"] = cases_json(j.finding.cases);
  }
  Json abstract = Json::array();
  for (const AbstractSentence& sentence : abstract_sentences())
    abstract.push_back({{"sentence", sentence.sentence}, {"claims", sentence.claims}});
  return {{"headline", headline_of(claims)}, {"abstract", std::move(abstract)}, {"claims", std::move(claims)}};
}

std::string ledger_markdown(const Json& ledger) {
  const Json& claims = ledger.at("claims");
  std::string text =
      "# The thesis, claim by claim\n\n*Reference.* " + text_at(ledger, "headline") +
      "\n\nIn the tables, *published* are numbers of the thesis, and *ours* are numbers of hapbench. "
      "Numbers such as 2.8 and A.3 are sections of the thesis. An id such as R1b links to the section of "
      "the claim in [claim_pages.md](claim_pages.md), which has the rule of the verdict. Terms of the tables (the "
      "[glossary](../../scenarios/GLOSSARY.md) has more):\n\n"
      "- *original*: the algorithm that the thesis examines in order to replace it (appendix B; the law "
      "`original_averaging`)\n"
      "- *shaping*: stiffness shaping, the algorithm that the thesis proposes (the law `shaped_stiffness`). In a few "
      "iterations, it gives each contact a weight, by which it multiplies the contact's stiffness\n"
      "- *stiffness ratio* of a contact: the combined stiffness of all contacts, measured along the direction of this "
      "contact, divided by the stiffness K of one contact\n"
      "- *raw points*: the colliding points before two stages. The *local average* merges the points of one cell of a "
      "grid, and the *reduction* keeps only the deepest contact of each group with similar gradients\n"
      "- *input force*: the force of the hand that the haptic device takes as input. The thesis limits it to 2 N "
      "(section 2.7)\n"
      "- *proxy*: a copy of the tool that stays outside of the surface while a spring pulls it to the tool\n"
      "- *tandpasta*: a law of appendix F, which weakens springs that oppose each other\n"
      "- *task 1*: the drill is pressed on a flat surface and dragged\n"
      "- *task 2*: the drill tilts to and fro in a hole\n"
      "- *task 3*: the drill moves along the wall of a hole, around the axis\n"
      "- *simulated hand*: in tasks 2 and 3, it presses gently, because only a gentle hand gives as few raw points as "
      "published; in other scenes, it presses harder, and the drill penetrates deeper\n"
      "- *vertical task*, *rotational task*: the two experiments of appendix D, in which people reach targets with a "
      "drill in a hole. In hapbench, simulated subjects do this\n\n"
      "## 1. What the abstract claims\n\n" +
      abstract_table(ledger) + "\nVerdicts:\n\n";
  for (const VerdictText& verdict : kVerdicts) text += fmt::format("- *{}*: {}.\n", verdict.name, verdict.meaning);
  text +=
      "\nRobustness: the thesis leaves some values open, so hapbench assumes them. Each assumption was set to each of "
      "its plausible values, one at a time. `hapbench describe NAME` "
      "explains an assumption or a claim; the claim pages have each value that changes a verdict, with the new verdict "
      "and number.\n\n"
      "- *exact*: no assumption enters the claim.\n"
      "- *robust*: no other value of any assumption changes the verdict.\n"
      "- *sensitive to* an assumption: only this assumption changes the verdict.\n"
      "- *depends on several*: each of the named assumptions alone changes the verdict.\n"
      "- *not sampled*: no other values were tried.\n";
  const std::string failing = failures(claims);
  text += "\n## 2. Claims that failed or were not judged\n\n" +
          (failing.empty() ? "" : "Claims about computing time are in part 4, also those that failed.\n\n" + failing);
  text +=
      "\n## 3. Claims by chapter\n\nClaims about computing time, and claims that are not testable, are in part 4.\n" +
      chapters(claims);
  text += "\n## 4. Computing times, claims that are not testable, changed rules and findings of this project\n";
  text += table_of(claims, "Computing time, on one machine (medians)",
                   [](const Json& claim) { return is(claim, "timing") && !is(claim, "ours"); });
  std::string untestable;
  for (const Json& claim : claims)
    if (verdict_of(claim) == Verdict::not_testable)
      untestable += fmt::format("- {}, {} ({}): {}.\n", link_to(claim), text_at(claim, "claim"),
                                text_at(claim, "place"), text_at(claim, "why"));
  if (!untestable.empty()) text += "\n### Not testable\n\n" + untestable;
  text += changed_rules(claims) + rules_before_measurement(claims);
  text += table_of(claims, "Findings of this project, which are no claims of the thesis",
                   [](const Json& claim) { return is(claim, "ours"); });
  return text +
         "\n[Controls](../../scenarios/thesis/README.md#controls) are runs with laws that are wrong on purpose, "
         "and with other values of K; the linked page lists the verdicts that change.\n"
         "\n[ERRATA.md](ERRATA.md) lists misprints of the thesis; [figures.md](figures/figures.md) has the figures.\n";
}

std::string claim_pages(const Json& ledger) {
  std::string text =
      "# Claims, one section each\n\n*Reference.* This page has a section for each claim of [the ledger](claims.md). "
      "`hapbench describe ID` prints the section of a claim.\n\n"
      "- **Published** and **Number**: the number of the thesis and the number of hapbench.\n"
      "- **Cases**: what was measured. `signed_distance` and `binary` are the two density fields from which the "
      "surface points of the block are computed.\n"
      "- **Rule**: the conditions of the verdict. After *qualitatively* follows the condition of the verdict "
      "*qualitatively replicated*. **Rule before** has the conditions of an earlier rule.\n"
      "- **Robustness**: each assumption that changes the verdict if it has another value. The ledger explains the "
      "words *robust*, *exact* and *not sampled*.\n"
      "- **Sensitivity**: values of assumptions that give another verdict, each with the verdict and the number that "
      "it gives. If the verdict is *not judged* or *not measured*, the value does not count for the robustness. *Not "
      "judged*: the simulated hand is fitted to a published number, which it does not reach with this value, or the "
      "run has nothing to measure. *Not measured*: a scenario cannot run with this value.\n"
      "- A section that begins with *Finding of this project* is about no claim of the thesis. The verdicts on "
      "findings are *holds* and *does not hold*.\n";
  for (const Json& claim : ledger.at("claims")) {
    text += fmt::format("\n## {}\n\n{}{} ({}).\n\n", text_at(claim, "id"),
                        is(claim, "ours") ? "*Finding of this project*: " : "", text_at(claim, "claim"),
                        text_at(claim, "place"));
    const auto item = [&text](const char* title, const std::string& of) {
      if (!of.empty()) text += fmt::format("- **{}**: {}\n", title, of);
    };
    item("Verdict", text_at(claim, "verdict"));
    item("Why", text_at(claim, "why"));
    item("Published", text_at(claim, "published"));
    item("Number", text_at(claim, "number"));
    item("Cases", text_at(claim, "measured"));
    item("Rule", text_at(claim, "rule"));
    if (claim.contains("revised")) {
      const Json& before = claim.at("revised");
      item("Rule before", fmt::format("{}. Verdict: {}; {}. Changed because {}", text_at(before, "rule"),
                                      text_at(before, "verdict"), robustness_text(before), text_at(before, "reason")));
    }
    item("Robustness", robustness_text(claim));
    std::string moved;
    for (const Json& one : claim.at("cases_moved"))
      append_item(moved, fmt::format("`{}` = {}: {}{}{}", text_at(one, "assumption"), text_at(one, "value"),
                                     text_at(one, "verdict"), text_at(one, "number").empty() ? "" : ", ",
                                     text_at(one, "number")));
    if (const auto tried = claim.at("cases_tried").get<std::size_t>(); tried > 0)
      item("Sensitivity",
           fmt::format("{} other values tried; {}", tried, moved.empty() ? "none changes the verdict" : moved));
    item("Figure", text_at(claim, "figure"));
    if (!claim.at("scenarios").empty())
      item("Scenarios", fmt::format("`{}`", fmt::join(claim.at("scenarios").get<std::vector<std::string>>(), "`, `")));
    item("Command", fmt::format("`{}` ({})", text_at(claim, "command"), seconds_text(claim)));
  }
  return text;
}

}  // namespace hapbench
