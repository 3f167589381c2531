#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/assumption_sets.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "scenarios/thesis/sensitivity.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::decide_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using test::read_file;

// Tests the results and files of `limit`, `tune` and `converge`. tests/data/golden/studies.txt has their printed
// texts.

using Words = std::vector<std::string>;

class Decide : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  ProgramRun ask(Words words, const Words& more, const std::string& out = "out") const {
    words.insert(words.end(), {"--out", file(out)});
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  test::TemporaryDirectory directory_;
};

class LimitCommand : public Decide {
 protected:
  LimitCommand() {
    // The scene has a probe that a hand with a mass presses on a plane of 49 points.
    test::write_plainly(directory_ / "press.json",
                        R"({"time": {"step_s": 0.001, "steps": 200}, "tool": {"diameter_m": 0.01, "length_m": 0.1},
                            "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.001},
                            "hand": {"type": "mass_spring_damper", "mass_kg": 0.2, "stiffness_N_per_m": 300,
                                     "damping_N_s_per_m": 6, "target": {"x_m": 0, "y_m": 0, "z_m": -0.003}},
                            "device": {"type": "impedance", "preset": "omega.3"},
                            "rendering": {"stiffness_N_per_m": 2000, "damping_ratio": 0,
                                          "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}})");
  }
  ProgramRun limit(const Words& more, const std::string& out = "out") const {
    return ask({"limit", file("press.json")}, more, out);
  }
};

TEST_F(LimitCommand, OnADeviceIsThatOfTheSceneWithIt) {
  const Words question = {"--algorithms", "shaped_stiffness,summation", "--vibration", "0.002", "--resolution", "0.01",
                          "--json"};
  Words with_device = question;
  with_device.insert(with_device.end(), {"--device", "omega.3", "--friction", "none"});
  const Json rows = limit(with_device).json()["limits"], own = limit(question, "own").json()["limits"];
  ASSERT_EQ(rows.size(), 2u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_TRUE(rows[i]["limit"].is_number());
    EXPECT_EQ(rows[i]["stable_low"], own[i]["stable_low"]);
    // Only the question without --device also verifies samples between the ends of the interval. Its limit is therefore
    // at most the limit of the question with --device.
    EXPECT_LE(own[i]["limit"], rows[i]["limit"]);
    EXPECT_EQ(own[i]["tried_between"], 48);
    EXPECT_EQ(rows[i]["tried_between"], 0);
    EXPECT_LE(rows[i]["vibration_m_per_s"], 0.002);
    EXPECT_EQ(rows[i]["published_N_per_m"], 5000.0);
  }
  for (const char* name : {"out/limit.csv", "own/limit.csv"})
    EXPECT_TRUE(lines_of(read_file(directory_ / name))[0].ends_with(",runs,non_monotonic_runs")) << name;
}

TEST_F(LimitCommand, GivesTheSameBytesWhateverTheJobs) {
  for (const char* jobs : {"1", "2"})
    EXPECT_EQ(limit({"--device", "ideal,admittance,touch", "--resolution", "0.5", "--jobs", jobs}, jobs).status, 0);
  test::expect_same_files(directory_ / "1", directory_ / "2");
}

class TuneCommand : public Decide {
 protected:
  /// Runs `tune` with a smaller range of zeta than the default, which halves the time.
  ProgramRun tune(const Words& more, const std::string& out = "out") const {
    return ask({"tune", "tap_wall", "--damping-ratio", "0.3:0.6"}, more, out);
  }
};

TEST_F(TuneCommand, ItsScenarioGivesTheMetricsThatWerePrinted) {
  // --device and --set replace the scene's device by another device and change one field of it. Merging by "extends"
  // alone would mix the fields of both devices.
  const Json json = tune({"--device", "touch", "--set", "device.delay_samples=0.5", "--bound", "inside_max_m=0.01",
                          "--algorithms", "shaped_stiffness,mean", "--json"})
                        .json();
  ASSERT_EQ(json["algorithms"].size(), 2u);
  ASSERT_TRUE(json["recommended"].is_string()) << json.dump(1);
  const Json* best = nullptr;
  for (const Json& law : json["algorithms"])
    if (law["algorithm"] == json["recommended"]) best = &law;
  ASSERT_NE(best, nullptr);
  EXPECT_TRUE((*best)["feasible"].get<bool>());
  EXPECT_GE((*best)["margins"]["gain"].get<double>(), 2.0);
  EXPECT_EQ(json["limits"]["inside_max_m"]["max"], 0.01);
  const std::string tuned = file("out/tap_wall_tuned.json");
  EXPECT_EQ(json["scenario"], tuned);
  const Json run = hapbench({"run", tuned, "--json", "--out", file("run")}).json();
  EXPECT_EQ(run[0]["algorithm"], json["recommended"]);
  for (const auto& [name, value] : (*best)["metrics"].items()) EXPECT_EQ(run[0]["metrics"][name], value) << name;
  const Json effective = Json::parse(read_file(file("run/scenario.effective.json")));
  EXPECT_EQ(effective["rendering"]["stiffness_N_per_m"], (*best)["stiffness_N_per_m"]);
  EXPECT_EQ(effective["device"]["delay_samples"], 0.5);
  std::size_t runs = 0;
  for (const Json& law : json["algorithms"]) runs += law["runs"].get<std::size_t>();
  EXPECT_EQ(json["runs"], runs);
  EXPECT_EQ(lines_of(read_file(file("out/tune.csv"))).size(), 3u);
  EXPECT_GT(lines_of(read_file(file("out/tune_trials.csv"))).size(), 30u);
}

/// Checks that `tune`, `limit` and the device table print the same recommended stiffness, linear limit and simulated
/// limit for one scene and device.
TEST_F(TuneCommand, PrintsTheLimitsThatLimitPrints) {
  const Json law = tune({"--device", "touch", "--json"}).json()["algorithms"][0];
  ASSERT_TRUE(law["simulated_limit_N_per_m"].is_number() && law["linear_limit_N_per_m"].is_number()) << law.dump(1);
  const std::string tuned = file("out/tap_wall_tuned.json");
  const auto asked = [&](Words words) {
    words.insert(words.begin(), {"limit", tuned, "--json", "--out", file("limit")});
    return hapbench(words).json()["limits"][0];
  };
  const Json limit = asked({}), in_table = asked({"--device", "touch", "--friction", "none"});
  EXPECT_EQ(limit["limit"], law["simulated_limit_N_per_m"]);
  EXPECT_EQ(limit["linear_limit"], law["linear_limit_N_per_m"]);
  EXPECT_EQ(in_table["stable_low"], limit["stable_low"]);
  EXPECT_NEAR(in_table["linear_limit"].get<double>(), limit["linear_limit"].get<double>(),
              0.01 * limit["linear_limit"].get<double>());
  EXPECT_GE(in_table["limit"], limit["limit"]) << "a table tries nothing between";
  EXPECT_GE(law["simulated_limit_N_per_m"].get<double>(), 2.0 * law["stiffness_N_per_m"].get<double>());
  EXPECT_GE(law["linear_limit_N_per_m"].get<double>(), 2.0 * law["stiffness_N_per_m"].get<double>());
}

/// Checks that a bound also holds if the error of the metric is added. The error is the change of the metric if the
/// time step or the point spacing is halved, or if the depth is evaluated in every step.
TEST_F(TuneCommand, KeepsALimitByTheErrorOfItsMetric) {
  const Json law = tune({"--bound", "inside_max_m=6e-4", "--json"}).json()["algorithms"][0];
  ASSERT_TRUE(law["feasible"].get<bool>()) << law.dump(1);
  const double error = law["error"]["inside_max_m"].get<double>();
  EXPECT_GT(error, 0.0);
  EXPECT_LE(law["metrics"]["inside_max_m"].get<double>() + error, 0.6e-3);
}

/// Checks that a bound of the user does not remove the requirement of low vibration, and that --allow-vibration removes
/// it.
TEST_F(TuneCommand, KeepsLowVibrationBesideABound) {
  const auto findings = [&](const Words& more, const std::string& out) {
    tune(more, out);
    return hapbench({"run", file(out + "/tap_wall_tuned.json"), "--json", "--out", file(out + "_run")})
        .json()[0]["diagnosis"];
  };
  for (const Json& finding : findings({"--bound", "inside_max_m=0.01", "--quiet"}, "bound"))
    for (const char* rule : {"buzz", "pop", "shake", "bounces", "chatter", "energy"})
      EXPECT_NE(finding["rule"], rule) << finding;
  const Json bound = tune({"--bound", "inside_max_m=0.01", "--json"}).json();
  const Json any = tune({"--allow-vibration", "--json"}).json();
  EXPECT_EQ(bound["limits"]["low_vibration"], true);
  EXPECT_EQ(any["limits"]["low_vibration"], false);
  EXPECT_GE(any["algorithms"][0]["stiffness_N_per_m"], bound["algorithms"][0]["stiffness_N_per_m"]);
}

/// Checks that without bounds of the user, the run of the recommended setting has low vibration by the rules of the
/// diagnosis.
TEST_F(TuneCommand, RecommendsAQuietRunInTheSameBytesHoweverManyJobs) {
  tune({"--jobs", "1", "--quiet"}, "a");
  tune({"--jobs", "3", "--quiet"}, "b");
  for (const char* name : {"tune.csv", "tune_trials.csv", "tap_wall_tuned.json"})
    EXPECT_EQ(read_file(directory_ / "a" / name), read_file(directory_ / "b" / name)) << name;
  const Json run = hapbench({"run", file("a/tap_wall_tuned.json"), "--json", "--out", file("run")}).json();
  for (const Json& finding : run[0]["diagnosis"])
    for (const char* rule : {"buzz", "pop", "shake", "bounces", "chatter", "energy"})
      EXPECT_NE(finding["rule"], rule) << finding;
}

class ConvergeCommand : public Decide {
 protected:
  ProgramRun converge(const Words& more, const std::string& out = "out") const {
    return ask({"converge", "springs_oscillation"}, more, out);
  }
};

TEST_F(ConvergeCommand, WritesTheSameBytesHoweverManyJobs) {
  const Json json = converge({"--metric", "force_max_N,inside_max_m", "--json"}, "one").json();
  ASSERT_EQ(json.size(), 2u);
  for (const Json& level : json[0]["levels"]) EXPECT_GT(level["seconds"], 0.0);
  EXPECT_TRUE(json[1]["order"].is_null() && json[1]["band"].is_null());
  EXPECT_EQ(converge({"--metric", "force_max_N", "--json"}).json()["metric"], "force_max_N") << "one alone is no list";
  converge({"--metric", "force_max_N,inside_max_m", "--jobs", "3", "--quiet"}, "three");
  for (const char* name : {"converge.csv", "converge_levels.csv"})
    EXPECT_EQ(read_file(directory_ / "one" / name), read_file(directory_ / "three" / name)) << name;
}

/// Checks the time step that `converge --to` prints: the largest step at which the error is below the limit. The error
/// of a metric that is a largest value includes the spread Metric::sampling_spread.
TEST_F(ConvergeCommand, NamesTheCoarsestLevelThatIsEnough) {
  for (const auto& [to, expected] :
       {std::pair{"0.03", "\nerror below 3 %: time.step_s = 0.00025 ("},
        {"1%", "\nerror below 1 %: not reached by any level; extrapolated: time.step_s = 3.8e-05"}}) {
    const std::string out = converge({"--metric", "force_max_N", "--to", to}).out;
    EXPECT_NE(out.find(expected), std::string::npos) << out;
  }
}

// Compares the committed ledger of claims, and the committed record of the robustness of its verdicts, with the output
// of `reproduce`, which creates both.

const fs::path kReference = fs::path(HAPBENCH_SCENARIOS) / "../../results/reference";

/// Returns the claims by id, without the processor time of each claim, and without claims whose findings contain times.
std::map<std::string, Json> repeatable_claims(const Json& ledger) {
  std::map<std::string, Json> claims;
  for (Json claim : ledger["claims"]) {
    claim.erase("seconds");
    if (!claim["timing"].get<bool>()) claims[claim["id"].get<std::string>()] = claim;
  }
  return claims;
}

TEST(Ledger, HasFourPartsWithANumberInEveryRow) {
  std::vector<std::string> parts;
  std::size_t rows = 0;
  for (const std::string& line : test::lines_of(test::read_file(kReference / "claims.md"))) {
    if (line.starts_with("## ")) parts.push_back(line.substr(3, 1));
    EXPECT_EQ(line.find("…"), std::string::npos) << "a cell is cut: " << line;
    if (!line.starts_with("| [")) continue;
    ++rows;
    std::vector<std::string> cells;
    for (const std::string_view cell : parts_of(line, '|')) cells.emplace_back(cell);
    ASSERT_EQ(cells.size(), 8u) << line;
    for (std::size_t i = 1; i < 7; ++i) EXPECT_GT(cells[i].size(), 2u) << line;
    EXPECT_NE(cells[4], " – ") << "no number: " << line;
  }
  EXPECT_EQ(parts, (std::vector<std::string>{"1", "2", "3", "4"}));
  EXPECT_EQ(rows, std::ranges::count_if(all_claims(), [](const Claim& claim) { return claim.judge != nullptr; }));
}

TEST(Ledger, HasBothVerdictsOfEveryChangedRuleAndBothRules) {
  const std::string page = test::read_file(kReference / "claims.md"),
                    sections = test::read_file(kReference / "claim_pages.md");
  const std::string changed = page.substr(page.find("### Rules that were changed"));
  const std::string table = changed.substr(0, changed.find("\n### ", 1));
  const Json ledger = Json::parse(test::read_file(kReference / "claims.json"));
  std::size_t revised = 0;
  for (const Json& claim : ledger["claims"]) {
    if (!claim.contains("revised")) continue;
    ++revised;
    const auto text = [](const Json& of, const char* key) { return of[key].get<std::string>(); };
    const std::string id = text(claim, "id"), before = text(claim["revised"], "verdict"), now = text(claim, "verdict");
    const std::string link = fmt::format("[{}](claim_pages.md#{})", id, lower_case(id));
    const std::string verdicts = fmt::format("\n| {} | {} | ", before, before == now ? "the same" : now);
    const auto row = table.find(verdicts);
    ASSERT_NE(row, std::string::npos) << id;
    EXPECT_LT(table.find(link, row), table.find('\n', row + 1)) << id;
    const auto section = sections.find("\n## " + id + "\n");
    ASSERT_NE(section, std::string::npos) << id;
    const std::string of_claim = sections.substr(section, sections.find("\n## ", section + 1) - section);
    EXPECT_NE(of_claim.find(text(claim, "rule")), std::string::npos) << id;
    EXPECT_NE(of_claim.find(text(claim["revised"], "rule")), std::string::npos) << id;
    EXPECT_NE(of_claim.find("Changed because " + text(claim["revised"], "reason")), std::string::npos) << id;
  }
  EXPECT_EQ(revised,
            std::ranges::count_if(all_claims(), [](const Claim& claim) { return !claim.earlier.rule.empty(); }));
}

TEST(Ledger, OpensWithTheSentencesOfTheAbstract) {
  const std::string page = test::read_file(kReference / "claims.md");
  for (const AbstractSentence& sentence : abstract_sentences()) {
    EXPECT_LT(page.find("| " + sentence.sentence + " |"), page.find("## 2.")) << sentence.sentence;
    for (const std::string& id : sentence.claims) EXPECT_EQ(std::ranges::count(all_claims(), id, &Claim::id), 1) << id;
  }
}

/// Compares the program's findings on these claims with the ledger in the source tree.
void expect_on_record(const Json& ledger, const std::vector<Claim>& claims) {
  const auto made = repeatable_claims(ledger),
             kept = repeatable_claims(Json::parse(test::read_file(kReference / "claims.json")));
  for (const Claim& claim : claims) {
    if (claim.timing) continue;
    ASSERT_TRUE(made.contains(claim.id) && kept.contains(claim.id)) << claim.id;
    EXPECT_EQ(made.at(claim.id), kept.at(claim.id))
        << claim.id << ": renew it with hapbench reproduce --ledger results/reference/claims.json";
  }
}

// Checks the claims without subjects. The claims about the subjects of appendix D take four fifths of the time of all
// claims, so they are left out. Instead, tests/data/numbers.txt stores the numbers of the subjects' trajectories.
TEST(Ledger, OfClaimsWithoutSubjectsIsTheOneTheProgramMakes) {
  std::vector<Claim> claims = all_claims();
  std::erase_if(claims, [](const Claim& claim) { return claim.timing || claim.costly; });
  std::string ids;
  for (const Claim& claim : claims) append_item(ids, claim.id, ",");
  const test::TemporaryDirectory directory;
  const std::string ledger = (directory / "claims.json").string();
  const test::ProgramRun run =
      hapbench({"reproduce", "--only", ids, "--out", (directory / "out").string(), "--ledger", ledger, "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  expect_on_record(Json::parse(test::read_file(ledger)), claims);
}

TEST(WholeLedger, InTheTreeIsTheOneTheProgramMakes) {
  const test::TemporaryDirectory directory;
  const test::ProgramRun run = hapbench({"reproduce", "--out", (directory / "out").string(), "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json ledger = Json::parse(test::read_file(directory / "out/claims.json")),
             on_record = Json::parse(test::read_file(kReference / "claims.json"));
  ASSERT_EQ(ledger["claims"].size(), on_record["claims"].size());
  EXPECT_EQ(ledger["headline"], headline_of(ledger["claims"]));
  // The verdict on a claim about time depends on the machine.
  Json claims = ledger["claims"];
  for (std::size_t i = 0; i < claims.size(); ++i)
    if (claims[i]["timing"]) claims[i] = on_record["claims"][i];
  EXPECT_EQ(on_record["headline"], headline_of(claims));
  expect_on_record(ledger, all_claims());
}

// Checks that a ledger of single claims is written only if --out names a folder, because it would replace the ledger of
// all claims.
TEST(Ledger, IsNotWrittenOfSingleClaimsUnlessItIsSaidWhere) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string(), ledger = (directory / "b3.json").string();
  std::filesystem::create_directories(out);
  test::write_plainly(directory / "out/claims.json", "mine");
  const test::ProgramRun run = hapbench({"reproduce", "--only", "b3", "--out", out});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("\nB3   claim: the merged depth"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\n     why: "), std::string::npos) << run.out;
  EXPECT_EQ(test::read_file(directory / "out/claims.json"), "mine");
  EXPECT_FALSE(std::filesystem::exists(directory / "out/claims.md"));
  ASSERT_EQ(hapbench({"reproduce", "--only", "B3", "--out", out, "--ledger", ledger}).status, 0);
  EXPECT_EQ(Json::parse(test::read_file(ledger))["claims"][0]["id"], "B3");
}

TEST(Ledger, ChecksTheFileBeforeTheRuns) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string();
  std::filesystem::create_directories(directory / "folder.json");
  // The ledger writes claims.md beside its JSON file, so a name that ends in .md would be written twice.
  for (const char* option : {"--ledger", "--sensitivity"})
    for (const char* name : {"claims.md", "claims", "folder.json"}) {
      const test::ProgramRun run =
          hapbench({"reproduce", "--only", "B3", "--out", out, option, (directory / name).string()});
      EXPECT_EQ(run.status, 2) << option << " " << name;
      EXPECT_NE(run.err.find(std::string(option) + ": got"), std::string::npos) << run.err;
      EXPECT_FALSE(std::filesystem::exists(directory / "out/thesis")) << "no run was made";
    }
  // A missing folder of the ledger is created.
  const std::string ledger = (directory / "new/folder/claims.json").string();
  ASSERT_EQ(hapbench({"reproduce", "--only", "B3", "--out", out, "--ledger", ledger}).status, 0);
  EXPECT_EQ(Json::parse(test::read_file(ledger))["claims"][0]["id"], "B3");
}

using Verdicts = std::map<std::string, std::string>;

/// Returns the ledger's verdicts by claim. Omits claims about times and claims that take long to judge.
Verdicts verdicts_on_record() {
  Verdicts verdicts;
  const Json ledger = Json::parse(test::read_file(kReference / "claims.json"));
  for (const Json& entry : ledger.at("claims"))
    verdicts[entry.at("id").get<std::string>()] = entry.at("verdict").get<std::string>();
  for (const Claim& claim : all_claims())
    if (claim.timing || claim.costly) verdicts.erase(claim.id);
  return verdicts;
}

/// Returns the verdicts on these claims with an assumption set.
Verdicts verdicts_under(const Assumptions& assumptions, AssumptionSet set) {
  std::vector<Claim> claims = all_claims();
  std::erase_if(claims, [](const Claim& claim) { return claim.timing || claim.costly || claim.judge == nullptr; });
  const test::TemporaryDirectory directory;
  const PublishedNumbers published(kReference / "published.json");
  const std::vector<SetFinding> found =
      judge_set({assumptions, published}, calibrated(std::move(set), assumptions), claims, directory / "set");
  Verdicts verdicts;
  for (std::size_t i = 0; i < claims.size(); ++i) verdicts[claims[i].id] = found[i].verdict;
  return verdicts;
}

// Checks stored verdicts with another value of one assumption. Takes a minute on one core.
TEST(RobustnessOnRecord, HasTheVerdictsThatTheProgramMakesWithAnotherAssumption) {
  const Json record = read_json(kReference / "sensitivity.json");
  if (record.at("claims").empty()) GTEST_SKIP() << "hapbench reproduce --sensitivity has not made the record yet";
  const Assumptions assumptions(kReference / "assumptions.json");
  AssumptionSet set{assumptions.recorded_values()};
  const auto& all = assumptions.all();
  set.values[static_cast<std::size_t>(std::ranges::find(all, "local.average", &Assumption::id) - all.begin())] =
      "false";
  const Verdicts made = verdicts_under(assumptions, set);
  std::size_t compared = 0;
  for (const Json& claim : record.at("claims"))
    for (const Json& one : claim.at("cases")) {
      const auto found = made.find(claim.at("id").get<std::string>());
      if (one.at("assumption") != "local.average" || found == made.end()) continue;
      ++compared;
      EXPECT_EQ(one.at("verdict"), found->second) << found->first;
    }
  EXPECT_GT(compared, 10u);
}

/// Checks that the values of the assumptions in the ledger, given as an assumption set, give the verdicts of the
/// ledger.
TEST(RobustnessOnRecord, OfTheAssumptionsOnRecordIsTheLedger) {
  const Assumptions assumptions(kReference / "assumptions.json");
  Verdicts on_record = verdicts_on_record();
  for (const Claim& claim : all_claims())
    if (claim.judge == nullptr) on_record.erase(claim.id);
  EXPECT_EQ(verdicts_under(assumptions, {assumptions.recorded_values()}), on_record);
}

/// Checks that the ledger uses the sensitivity record: if the record of a claim is complete, the ledger states another
/// robustness than "not sampled", and the number of cases of the record.
TEST(RobustnessOnRecord, IsInTheLedger) {
  const SensitivityRecord record(kReference / "sensitivity.json");
  const Json ledger = read_json(kReference / "claims.json");
  for (const Json& claim : ledger.at("claims")) {
    const auto scenarios = claim.at("scenarios").get<std::vector<std::string>>();
    const Assumptions assumptions(kReference / "assumptions.json");
    const std::string id = claim.at("id").get<std::string>();
    const std::vector<Claim> claims = all_claims();
    const std::string& rule = std::ranges::find(claims, id, &Claim::id)->rule;
    const Json entry = record.entry(id, assumptions.reach(scenarios, rule));
    if (entry.is_null() || entry.at("cases").size() < entry.at("complete").get<std::size_t>()) continue;
    EXPECT_NE(claim.at("robustness"), "not sampled")
        << id << ": renew it with hapbench reproduce --ledger results/reference/claims.json";
    EXPECT_EQ(claim.at("cases_tried"), entry.at("cases").size()) << id;
  }
}

}  // namespace
}  // namespace hapbench::decide_test
