#include "scenarios/thesis/claims.hpp"

#include <fmt/ranges.h>

#include <array>
#include <numbers>
#include <regex>

#include "scenarios/batch/statistics.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

namespace fs = std::filesystem;

PublishedNumbers::PublishedNumbers(const fs::path& file) {
  try {
    const Json json = with_file(file, [&] { return read_json(file); });
    for (const Json& value : json.at("values")) {
      PublishedNumber& number = numbers_[value.at("id").get<std::string>()];
      for (const char* key : {"mean", "value"}) number.mean = value.value(key, number.mean);
      for (const char* key : {"std", "standard_error"}) number.spread = value.value(key, number.spread);
      number.at_least = value.value("at_least", number.at_least);
      number.at_most = value.value("at_most", number.at_most);
    }
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("{}: is no file of published numbers: {}", file.string(), problem.what()));
  }
}

std::string PublishedNumbers::fill(const std::string& text) const {
  // An id, and perhaps a part of the number with a factor and a format.
  static const std::regex kNumber(
      R"(<([^<>*:]+?)(?:\.(mean|spread|at_least|at_most)(?:\*([^<>:]+))?(?::([^<>]+))?)?>)");
  std::string filled;
  auto end = text.begin();
  for (std::sregex_iterator found(text.begin(), text.end(), kNumber), none; found != none; ++found) {
    const std::smatch& match = *found;
    filled.append(end, match[0].first);
    end = match[0].second;
    const PublishedNumber& number = (*this)[match[1]];
    if (!match[2].matched) {
      filled += plain(number.mean) + (number.spread > 0.0 ? " ± " + plain(number.spread) : "");
      continue;
    }
    const double part = match[2] == "mean"       ? number.mean
                        : match[2] == "spread"   ? number.spread
                        : match[2] == "at_least" ? number.at_least
                                                 : number.at_most;
    const double scaled = match[3].matched ? part * finite_number(match[3].str()).value() : part;
    if (std::isnan(scaled))
      filled += "none";
    else
      filled += match[4].matched ? fmt::format(fmt::runtime("{:" + match[4].str() + "}"), scaled) : plain(scaled);
  }
  return filled.append(end, text.end());
}

void for_each_row(const LoadedScenario& loaded, const std::function<void(const StepRecord&)>& row) {
  class RowObserver final : public Observer {
   public:
    explicit RowObserver(const std::function<void(const StepRecord&)>& row_of) : row_(row_of) {}
    bool wants_found() const noexcept override { return true; }
    void on_step(const StepRecord& record) noexcept override { row_(record); }

   private:
    const std::function<void(const StepRecord&)>& row_;
  } observer(row);
  const auto shell = make_shell(loaded.scenario, loaded.files);
  Simulation simulation(simulation_config(loaded.scenario), assemble(loaded.scenario, loaded.files, shell, {}),
                        {&observer});
  run_to_end(simulation);
}

Finding Claim::finding(const Evidence& evidence) const {
  if (judge == nullptr) return {Verdict::not_reproducible, why};
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
  std::map<std::string, ClaimRule> rules;
  for (const auto chapter :
       {chapters_1_and_4, chapter_3, chapter_3_cost, appendix_a, appendix_b_c_f, appendix_d_experiments})
    for (const ClaimRule& rule : chapter()) rules[rule.id] = rule;
  const std::filesystem::path file = installed_folder("results/reference") / "rules.json";
  const auto text = [](const Json& row, const char* key) { return row.at(key).get<std::string>(); };
  std::vector<Claim> claims;
  try {
    const Json json = read_json(file);
    for (const Json& row : json.at("claims")) {
      Claim& claim = claims.emplace_back(Claim{.id = text(row, "id"),
                                               .place = text(row, "place"),
                                               .claim = text(row, "claim"),
                                               .published = row.value("published", ""),
                                               .rule = text(row, "rule"),
                                               .why = row.value("why", ""),
                                               .measured = row.value("measured", ""),
                                               .each = row.value("each", ""),
                                               .timing = row.value("timing", false),
                                               .ours = row.value("ours", false),
                                               .costly = row.value("costly", false),
                                               .drawn = row.value("drawn", false)});
      if (const Json main = row.value("main", Json()); !main.is_null())
        claim.main = {text(main, "claim"), text(main, "published"), text(main, "ours")};
      if (!claim.why.empty()) continue;
      claim.measure = rules.at(claim.id).measure;
      claim.judge = rules.at(claim.id).judge;
    }
  } catch (const std::exception& problem) {
    fail_in_file(file, fmt::format("is no file of claims, after {} of them: {}", claims.size(), problem.what()));
  }
  return claims;
}

// ---- Measurements and scenes that several claims share

std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride, Points points) {
  LoadedScenario loaded;
  loaded.scenario = drill_in_hole(scenario);
  if (points == Points::colliding) {
    loaded.scenario.rendering.reduction.reset();
    loaded.scenario.rendering.local_average = false;
  }
  std::vector<ContactBuffer> sets;
  for_each_row(loaded, [&](const StepRecord& row) {
    if (row.step % stride != 0 || row.rendered->empty()) return;
    sets.emplace_back(row.rendered->size()).assign(*row.rendered);
  });
  return sets;
}

std::optional<double> damping_ratio_of_swings(std::span<const double> x) {
  constexpr double kSmallest = 1e-6;  // [m]
  std::vector<double> extremes;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    if ((x[i] - x[i - 1]) * (x[i + 1] - x[i]) >= 0.0) continue;
    if (std::abs(x[i]) < kSmallest) break;
    extremes.push_back(std::abs(x[i]));
  }
  if (extremes.size() < 2) return std::nullopt;
  const double q = math::pow(extremes.back() / extremes.front(), 1.0 / static_cast<double>(extremes.size() - 1));
  if (q >= 1.0) return 0.0;
  const double log_q = math::log(q);
  return -log_q / std::sqrt(std::numbers::pi * std::numbers::pi + log_q * log_q);
}

// ---- The ledger

namespace {

constexpr const char *kSteady = "steady", *kFragile = "fragile", *kNotSampled = "not sampled";

std::string text_at(const Json& claim, const char* key) {
  return claim.at(key).get<std::string>();
}

bool is_ours(const Json& claim) {
  return claim.at("ours").get<bool>();
}

/// Steady: more than half of the samples have the recorded verdict.
const char* sureness(const Json& robustness) {
  if (robustness.is_null()) return kNotSampled;
  const auto judged = robustness.at("judged").get<std::size_t>(), holds = robustness.at("holds").get<std::size_t>();
  return 2 * holds > judged ? kSteady : kFragile;
}

Verdict verdict_of(const Json& claim) {
  const auto* found = std::ranges::find(kVerdicts, text_at(claim, "verdict"), &VerdictText::name);
  return static_cast<Verdict>(found - std::begin(kVerdicts));
}

/// At most `most` characters of it: whole words, with an ellipsis for the rest.
std::string shortened(const std::string& text, std::size_t most) {
  if (characters_of(text) <= most) return text;
  std::size_t end = 0;
  for (std::size_t i = 0, seen = 0; i < text.size() && seen < most; ++i) {
    if (begins_character(text[i])) ++seen;
    if (text[i] == ' ') end = i;
  }
  return text.substr(0, text.find_last_not_of(" ,;:", end) + 1) + " …";
}

/// The chapter or appendix of its first place with a number: "C" of "abstract, C.2".
std::string chapter_of(const Json& claim) {
  const std::string place = text_at(claim, "place");
  const std::size_t number = place.find_first_of("0123456789");
  const bool appendix = number >= 2 && place[number - 1] == '.';
  return std::string(1, place.at(appendix ? number - 2 : number));
}

/// A line for each chapter, a mark for each of its claims.
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

/// The heading of a table whose first columns are these two.
std::string heading(const char* columns) {
  return fmt::format(
      "| {} | published | ours | verdict | sureness | command | seconds |\n|---|---|---|---|---|---|---|---|\n",
      columns);
}

/// The last cells of a row, with the whole seconds that it takes to judge the claim.
std::string last_cells(const Json& claim) {
  const double seconds = claim.at("seconds").get<double>();
  return fmt::format(" | {} | {} | `{}` | {} |", text_at(claim, "verdict"), text_at(claim, "sureness"),
                     text_at(claim, "command"), seconds < 1.0 ? "< 1" : fmt::format("{:.0f}", seconds));
}

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

std::string row_of(const Json& claim) {
  constexpr std::size_t kClaim = 90, kPublished = 50, kLongestRow = 300;  // characters; `describe ID` says the rest
  const std::string before =
      fmt::format("| {} | {} | {} | ", text_at(claim, "id"), shortened(text_at(claim, "claim"), kClaim),
                  shortened(text_at(claim, "published"), kPublished));
  const std::string after = last_cells(claim);
  const std::size_t ellipsis = 2, room = kLongestRow - characters_of(before + after) - ellipsis;
  return before + shortened(text_at(claim, "measured"), room) + after + "\n";
}

/// The numbers of each case, lists where there are several.
Json cases_json(const Measured& cases) {
  Json json = Json::array();
  for (const MeasuredCase& m : cases) {
    Json& values = json.emplace_back(Json{{"name", m.name}})["values"];
    for (const auto& [name, all] : m.values) values[name] = all.size() == 1 ? Json(all.front()) : Json(all);
  }
  return json;
}

/// The entry of a claim in robustness.json; null where that is not about this verdict and the choices that reach it.
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
  std::string text =
      main_results(claims) + "\n" + text_at(ledger, "headline") + " By chapter:\n\n" + chapter_bars(claims) + "\n";
  for (std::size_t v = 0; v <= static_cast<std::size_t>(Verdict::not_reproducible); ++v)
    text += fmt::format("{} *{}*: {}.  \n", kVerdicts[v].mark, kVerdicts[v].name, kVerdicts[v].meaning);
  text += "\nMore of a row: `hapbench describe ID`.\n\n" + heading("id | claim");
  for (const Verdict verdict : {Verdict::refuted, Verdict::not_reproduced, Verdict::in_kind, Verdict::reproduced})
    for (const Json& claim : claims)
      if (!is_ours(claim) && verdict_of(claim) == verdict) text += row_of(claim);
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
