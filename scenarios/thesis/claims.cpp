#include "scenarios/thesis/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "scenarios/cases/league.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

PublishedNumber number_of(const Json& value) {
  PublishedNumber number;
  for (const char* key : {"mean", "value"}) number.mean = value.value(key, number.mean);
  for (const char* key : {"std", "standard_error"}) number.spread = value.value(key, number.spread);
  number.at_least = value.value("at_least", number.at_least);
  number.at_most = value.value("at_most", number.at_most);
  return number;
}

}  // namespace

PublishedNumbers::PublishedNumbers(const fs::path& file) {
  try {
    const Json json = read_json(file);
    for (const Json& value : json.at("values")) numbers_[value.at("id")] = number_of(value);
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("{}: is no file of published numbers: {}", file.string(), problem.what()));
  }
}

const PublishedNumber& PublishedNumbers::operator[](const std::string& id) const {
  const auto found = numbers_.find(id);
  if (found == numbers_.end()) throw InputError(fmt::format("the published numbers hold no \"{}\"", id));
  return found->second;
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

double Evidence::number(const std::string& scenario, const std::string& path) const {
  provide(scenario);
  std::string pointer = "/" + path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  const Json summary = read_json(directory / scenario / "summary.json");
  const Json value = summary.value(Json::json_pointer(pointer), Json());
  return value.is_number() ? value.get<double>() : std::nan("");
}

std::map<std::string, std::vector<double>> Evidence::table(const std::string& scenario, const std::string& file) const {
  provide(scenario);
  const fs::path path = directory / scenario / file;
  const std::string text = read_named_file(path);
  if (text.empty()) fail_in_file(path, "is empty; allowed: a header and rows");
  CsvReader csv{LineReader(text), path};
  std::vector<std::vector<double>*> columns;
  std::map<std::string, std::vector<double>> table;
  for (const std::string_view name : csv.columns()) columns.push_back(&table[std::string(name)]);
  while (csv.next()) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      columns[i]->push_back(finite_number(csv.cells()[i]).value_or(std::nan("")));
  }
  return table;
}

Cases Evidence::scene(const std::string& name, const std::vector<std::string>& more) const {
  if (used) used(name);
  const ScenarioText text = read_scenario_text(find_scenario(name));
  std::vector<std::string> all;
  if (overrides) all = overrides(load_scenario(text, {}).scenario);
  all.insert(all.end(), more.begin(), more.end());
  return {{text}, std::move(all), {}};
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

std::string plain(double number) {
  std::string text = fmt::format("{:g}", number);
  // An exponent without its leading zero.
  if (const auto exponent = text.find("e-0"); exponent != std::string::npos) text.erase(exponent + 2, 1);
  return text;
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
  for (const auto chapter : {chapter_1_penetration, chapter_3_tasks, chapter_3_cost, chapter_3_stiffness_ratios,
                             chapter_3_force_limit, chapter_4, appendix_a, appendix_b_c_f, appendix_d_experiments})
    for (const ClaimRule& rule : chapter()) rules[rule.id] = rule;
  const std::filesystem::path file = installed_folder("results/reference") / "rules.json";
  std::vector<Claim> claims;
  try {
    const Json json = read_json(file);
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
      if (!claim.why.empty()) continue;
      claim.measure = rules.at(claim.id).measure;
      claim.judge = rules.at(claim.id).judge;
    }
  } catch (const std::exception& problem) {
    fail_in_file(file, fmt::format("is no file of claims, after {} of them: {}", claims.size(), problem.what()));
  }
  return claims;
}

}  // namespace hapbench
