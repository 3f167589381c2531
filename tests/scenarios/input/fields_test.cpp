#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "algorithms/registry.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/json_schema.hpp"
#include "scenarios/input/reader.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mutation.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/scenarios/support/schema_validator.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::fields_test {
namespace {

namespace fs = std::filesystem;
using test::NamedScenario;

// Values at the edge of what is read, and how messages name a place (JSON pointer, RFC 6901) and show a value. What
// refusals say is in tests/data/golden/refused_scenarios.txt; that reader and schema agree about every field, below.

constexpr std::int64_t kMost = std::int64_t{1} << 53;

std::int64_t count_of(const Json& json) {
  std::int64_t count = -1;
  read_value(json, "/v", [&count](Fields& f) { f.integer(count, {1, kMost}); });
  return count;
}

TEST(Number, IsRefusedWhenNotFinite) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    double out = 1.0;
    const auto number = [&out](Fields& f) { f.number(out, {0.0, 10.0, "N"}); };
    EXPECT_TRUE(test::input_error_of([&] { read_value(Json(value), "/v", number); }));
    EXPECT_EQ(out, 1.0);
  }
}

TEST(Integer, MayBeWrittenAsAnyWholeNumber) {
  for (const char* text : {"1000", "1e3", "1000.0"}) EXPECT_EQ(count_of(Json::parse(text)), 1000);
  EXPECT_EQ(count_of(Json::parse("9007199254740992")), kMost);
}

TEST(Integer, IsRefusedAsAFractionAndBeyondItsBounds) {
  // 2^53 + 1 has no double of its own and would round to the bound 2^53.
  for (const char* text : {"1.5", "0", "-1", "9007199254740993", "9007199254740994", "1e300", "-1e300",
                           "18446744073709551615", "-9223372036854775808"}) {
    const auto error = test::input_error_of([text] { count_of(Json::parse(text)); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(error->problem().find("allowed: an integer 1 ... 9007199254740992"), std::string::npos);
  }
}

TEST(Text, IsMeasuredInCharactersNotBytes) {
  std::string text;
  const auto short_text = [&text](Fields& f) { f.text(text, 3); };
  for (const char* three : {"äöü", "😀😀😀"}) {
    read_value(three, "/v", short_text);
    EXPECT_EQ(text, three);
  }
  EXPECT_TRUE(test::input_error_of([&] { read_value("äöüß", "/v", short_text); }));
}

TEST(Fields, OfOneObjectExcludeEachOtherInOnePairAtMost) {
  const auto twice = [](Fields& f) {
    f.exactly_one_of("a", "b");
    f.exactly_one_of("c", "d");
  };
  EXPECT_THROW(guide_to([&](Fields& f) { f.fields(twice); }), std::logic_error);
}

TEST(Object, HasNoMoreFaultsReportedThanAnybodyReads) {
  Json json = test::minimal_scenario("plane");
  for (std::size_t i = 0; i < 10 * kMostFaults; ++i) json["key" + std::to_string(i)] = 0;
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->faults().size(), kMostFaults);
}

TEST(Pointer, EscapesTildeAndSlashAsRfc6901Says) {
  // The examples of RFC 6901, section 5.
  EXPECT_EQ(member("", "a/b"), "/a~1b");
  EXPECT_EQ(member("", "m~n"), "/m~0n");
  EXPECT_EQ(member("", "~1"), "/~01");
  EXPECT_EQ(member("", ""), "/");
  EXPECT_EQ(element(member("", "foo"), 0), "/foo/0");
}

TEST(Pointer, IsOneShortLineWhateverTheKey) {
  EXPECT_EQ(member("", std::string(1'000'000, 'k')), "/" + std::string(200, 'k'));
  EXPECT_EQ(member("", "a\nb\tc\x1b"), "/a?b?c?");
}

TEST(ShownValue, IsShortAndInAscii) {
  EXPECT_EQ(shown(Json(std::string(1000, 'x'))), "\"" + std::string(79, 'x') + "...");
  EXPECT_EQ(shown(Json(std::vector<int>(1'000'000))), "a list of 1000000 entries");
  for (const char* bytes : {"\xc3\xa4", "\xff\xfe", "\xed\xa0\x80", "\xe2\x80\xa8"}) {
    const std::string text = shown(Json(bytes));
    EXPECT_EQ(text.find_first_not_of("\"\\u0123456789abcdef"), std::string::npos) << text;
  }
}

// The typed reader and the JSON Schema it emits say the same about every document, judged by a validator that is not
// ours.

const test::SchemaValidator& schema() {
  static const test::SchemaValidator validator(scenario_schema());
  return validator;
}

/// The reader's objection; none when it accepts.
std::optional<InputError> objection_to(const Json& document) {
  try {
    read_scenario(document, "");
    return std::nullopt;
  } catch (const InputError& error) {
    return error;
  }
}

/// The scenarios written for tests first: every field is in one of them, while bundled ones resemble each other.
std::vector<NamedScenario> valid_scenarios() {
  std::vector<NamedScenario> all = test::rich_scenarios();
  for (const auto& more : {test::minimal_scenarios(), test::bundled_scenario_files()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

/// How many mutants of the i-th of them to look at.
std::size_t mutants_of(std::size_t i) {
  return test::cases(i < test::rich_scenarios().size() ? 4000 : 300);
}

TEST(ScenarioSchema, InTheTreeIsTheOneTheProgramEmits) {
  const auto file = std::filesystem::path(HAPBENCH_SCENARIOS) / "scenario.schema.json";
  EXPECT_EQ(read_text_file(file, kLargestJsonFile), json_text(scenario_schema()))
      << "regenerate it: hapbench describe schema > scenarios/library/scenario.schema.json";
}

TEST(ScenarioSchema, AcceptsEveryValidScenarioAndItsEffectiveForm) {
  for (const NamedScenario& scenario : valid_scenarios()) {
    EXPECT_EQ(schema().complaints(scenario.json), "") << scenario.name;
    const Json effective = effective_scenario(read_scenario(scenario.json, "").scenario, "");
    EXPECT_EQ(schema().complaints(effective), "") << scenario.name;
  }
}

TEST(ScenarioSchema, HasAnExampleInTheTestsForEveryField) {
  // Otherwise the mutations below could not reach it.
  std::set<std::string> seen, known;
  for (const NamedScenario& scenario : valid_scenarios()) {
    for (const std::string& at : test::pointers_in(scenario.json)) {
      if (!at.empty()) seen.insert(Json::json_pointer(at).back());
    }
  }
  const Json document = scenario_schema();
  for (const std::string& at : test::pointers_in(document)) {
    const Json::json_pointer pointer(at);
    if (!at.empty() && !pointer.parent_pointer().empty() && pointer.parent_pointer().back() == "properties" &&
        at.find("/metrics/") == std::string::npos && at.find("/default/") == std::string::npos) {
      known.insert(pointer.back());
    }
  }
  seen.insert("extends");  // what is read in memory extends nothing; the tests below have it
  seen.insert("config");   // of a library, which tests/data cannot hold; the tests of its sources have it
  for (const std::string& field : known) EXPECT_TRUE(seen.contains(field)) << field;
}

TEST(ScenarioSchema, AcceptsFilesThatExtendOthersAsTheyStand) {
  std::size_t extending = 0;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const Json json = read_json(bundled.file);
    EXPECT_EQ(schema().complaints(json), "") << bundled.name;
    if (json.contains("extends")) ++extending;
  }
  EXPECT_GT(extending, 0u);
  const auto accepts = [](const char* text) { return schema().accepts(Json::parse(text)); };
  EXPECT_TRUE(accepts(R"({"extends": "poke_plane"})"));
  EXPECT_TRUE(accepts(R"({"extends": "poke_plane", "environment": {"size_m": 1}, "rendering": {"reduction": null}})"));
  EXPECT_FALSE(accepts(R"({"extends": 5})"));
  EXPECT_FALSE(accepts(R"({"extends": "poke_plane", "rendreing": {}})"));
  EXPECT_FALSE(accepts(R"({"extends": "poke_plane", "rendering": {"mass_kg": -1}})"));
  EXPECT_FALSE(accepts(R"({"environment": {"type": "plane"}})"));
}

/// Expects schema and reader to agree on a mutant; `objection` is the reader's.
void expect_agreement(const test::Mutation& mutant, const std::optional<InputError>& objection,
                      const std::string& name) {
  const bool accepted = schema().accepts(mutant.document);
  const bool wrong_shape = objection && objection->kind() == InputError::Kind::shape;
  EXPECT_EQ(wrong_shape, !accepted) << name << " " << mutant.change
                                    << "\n reader: " << (objection ? objection->what() : "fine")
                                    << "\n schema: " << schema().complaints(mutant.document);
  if (!objection) return;
  const std::string message = objection->what();
  EXPECT_EQ(message.find_first_of("\n\r"), std::string::npos) << name << " " << mutant.change;
  EXPECT_NE(message.find("allowed"), std::string::npos) << name << " " << mutant.change << ": " << message;
  // The place is in the document, unless it is a field left at its default that contradicts what was given.
  EXPECT_TRUE(!wrong_shape || mutant.document.contains(Json::json_pointer(objection->place()))) << message;
}

TEST(ScenarioSchema, RejectsExactlyTheMutantsWhoseShapeTheReaderRefuses) {
  Random random(2024);
  const std::vector<NamedScenario> scenarios = valid_scenarios();
  std::size_t refused = 0, related = 0, total = 0;
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    const std::size_t mutants = mutants_of(s);
    for (std::size_t i = 0; i < mutants && !HasFailure(); ++i, ++total) {
      const test::Mutation mutant = test::mutated(scenarios[s].json, random);
      const std::optional<InputError> objection = objection_to(mutant.document);
      expect_agreement(mutant, objection, scenarios[s].name);
      if (objection) ++(objection->kind() == InputError::Kind::shape ? refused : related);
    }
  }
  // The mutants are neither all good nor all bad, or the test would show little.
  EXPECT_GT(refused, total / 2);
  EXPECT_LT(refused, total * 9 / 10);
  EXPECT_GT(related, total / 1000);
}

TEST(ScenarioSchema, RejectsNothingThatTheReaderAcceptsAfterManyChanges) {
  // With several things wrong the reader may meet a contradiction first; acceptance still means the same to both.
  Random random(7);
  const std::size_t per_scenario = test::cases(150);
  for (const NamedScenario& scenario : valid_scenarios()) {
    for (std::size_t i = 0; i < per_scenario && !HasFailure(); ++i) {
      test::Mutation mutant{scenario.json, ""};
      for (int changes = 0; changes < 4; ++changes) mutant = test::mutated(mutant.document, random);
      const auto objection = objection_to(mutant.document);
      const bool accepted = schema().accepts(mutant.document);
      EXPECT_FALSE(!objection && !accepted) << mutant.document << schema().complaints(mutant.document);
      EXPECT_FALSE(objection && objection->kind() == InputError::Kind::shape && accepted)
          << mutant.document << objection->what();
    }
  }
}

// The values that a scenario has where its file says nothing, those of the thesis for that kind of scene (Tables A.1,
// A.2, B.1), and the effective scenario: with every default filled in, a file that means the same.

struct Expected {
  const char* pointer;
  const char* json;
};

LoadedScenario loaded(const Json& json) {
  return read_scenario(json, "");
}
Json effective(const Json& json) {
  return effective_scenario(loaded(json).scenario, "");
}

void expect_fields(const Json& json, std::initializer_list<Expected> fields) {
  for (const Expected& field : fields) {
    EXPECT_EQ(json.at(Json::json_pointer(field.pointer)), Json::parse(field.json)) << field.pointer;
  }
}

/// The minimal scenario of an environment, changed by a JSON merge patch (RFC 7386).
Json patched(const std::string& environment, const char* patch) {
  Json json = test::minimal_scenario(environment);
  json.merge_patch(Json::parse(patch));
  return json;
}

TEST(Defaults, OfTheSceneAreThoseOfTheThesis) {
  for (const char* environment : {"springs", "hole_2d", "plane", "slot", "block_with_hole", "point_shell", "mesh"}) {
    SCOPED_TRACE(environment);
    const std::string name = environment;
    const bool springs = name == "springs", planar = springs || name == "hole_2d";
    expect_fields(effective(test::minimal_scenario(environment)),
                  {{"/rendering/mass_kg", planar ? "0.2" : "0.1"},
                   {"/rendering/friction", springs ? R"({"mu_s_N_s_per_m": 0.0, "mu_f_s_per_m": 0.0})"
                                                   : R"({"mu_s_N_s_per_m": 5.0, "mu_f_s_per_m": 10.0})"},
                   {"/rendering/reduction", "null"},
                   {"/tool", name == "hole_2d" ? R"({"diameter_m": 0.001, "length_m": 0.005, "tip": "round"})"
                                               : R"({"diameter_m": 0.001, "length_m": 0.01, "tip": "flat"})"},
                   {"/motion/orientation/up", planar ? "[0.0, 1.0, 0.0]" : "[0.0, 0.0, 1.0]"}});
  }
}

TEST(Defaults, GiveWayToWhatIsGiven) {
  expect_fields(effective(patched("hole_2d", R"({
                  "rendering": {"mass_kg": 1, "reduction": {"max_points": 5}, "friction": {"mu_s_N_s_per_m": 1}},
                  "tool": {"length_m": 1, "tip": "flat"}})")),
                {{"/rendering/mass_kg", "1.0"},
                 {"/rendering/reduction", R"({"threshold": 0.995, "max_points": 5, "shuffle_seed": null})"},
                 {"/rendering/friction", R"({"mu_s_N_s_per_m": 1.0, "mu_f_s_per_m": 10.0})"},
                 {"/tool", R"({"diameter_m": 0.001, "length_m": 1.0, "tip": "flat"})"}});
}

TEST(Duration, BecomesARoundedNumberOfSteps) {
  Json json = test::minimal_scenario("springs");
  json["time"] = {{"step_s", 1.0 / 2048.0}, {"duration_s", 1.0}};
  EXPECT_EQ(effective(json)["time"], Json::parse(R"({"step_s": 0.00048828125, "steps": 2048, "stop_when": []})"));
  json["time"] = {{"step_s", 0.0005}, {"duration_s", 0.1}};  // 0.1 / 0.0005 is not 200 to the last bit
  EXPECT_EQ(effective(json)["time"]["steps"], 200);
}

TEST(AdmittanceDevice, WarnsUnderAHandThatDoesNotFeelTheHandle) {
  const auto warnings = [](const char* hand, const char* device) {
    Json json = test::minimal_scenario("plane");
    json["hand"] = Json::parse(hand);
    json["device"] = Json::parse(device);
    return loaded(json).warnings;
  };
  constexpr const char* kDelay = R"({"type": "admittance", "servo": {"delay_samples": 20}})";
  for (const char* device : {kDelay, R"({"type": "admittance"})"}) {
    ASSERT_EQ(warnings(R"({"type": "none"})", device).size(), 1u) << device;
    EXPECT_EQ(warnings(R"({"type": "none"})", device)[0].told().find("/device: servo and mechanics"), 0u);
  }
  EXPECT_EQ(warnings(R"({"type": "push", "force_N": 1})", kDelay).size(), 1u);
  EXPECT_TRUE(warnings(R"({"type": "push", "force_N": 1})", R"({"type": "ideal"})").empty());
  EXPECT_TRUE(warnings(R"({"type": "none"})", R"({"type": "admittance", "sensor": {"noise_N": 0.02}})").empty())
      << "sensor and limiter work whatever the hand";
  EXPECT_TRUE(warnings(R"({"type": "impedance", "target": {"x_m": 0, "y_m": 0, "z_m": 0}})", kDelay).empty());
}

Json effective_device(const char* device) {
  Json json = test::minimal_scenario("plane");
  json["device"] = Json::parse(device);
  return effective(json)["device"];
}

TEST(ImpedanceDevice, WritesTheNumbersOfAPresetInFull) {
  const Json device = effective_device(R"({"type": "impedance", "preset": "touch", "force_max_N": null})");
  EXPECT_EQ(device, Json::parse(R"({"type": "impedance", "handle_mass_kg": 0.045, "viscous_N_s_per_m": 0.1,
    "coulomb_N": 0.2, "encoder_step_m": 5.5e-5, "delay_samples": 0.0, "velocity_filter": {"type": "difference"},
    "force_max_N": null, "force_step_N": 0.0, "force_slew_N_per_s": null, "position_filter": null,
    "position_noise_m": 0.0})"));
  EXPECT_EQ(effective_device(device.dump().c_str()), device) << "which is the same device again";
  EXPECT_EQ(effective_device(R"({"type": "impedance", "preset": "omega.3"})")["force_max_N"], 12.0);
}

TEST(ScenarioInCode, IsThatOfSpringsWithoutAnyField) {
  Json springs = test::minimal_scenario("springs");
  springs["time"]["steps"] = 1;
  EXPECT_EQ(effective_scenario(Scenario{}, ""), effective(springs));
}

TEST(ScenarioInCode, HasWhatAnotherAlgorithmFixes) {
  const Scenario given = loaded(test::minimal_scenario("plane")).scenario;
  for (const AlgorithmEntry& entry : algorithms()) {
    Json json = test::minimal_scenario("plane");
    json["rendering"]["algorithm"] = entry.info->name;
    EXPECT_EQ(effective_scenario(with_algorithm(given, entry.info->name), ""), effective(json)) << entry.info->name;
  }
}

std::string content_hash(const Scenario& scenario) {
  return scenario_hash(effective_scenario(scenario, {}), NamedFiles(scenario));
}

void expect_fixed_point(const Scenario& scenario, const fs::path& directory) {
  const Json effective = effective_scenario(scenario, directory);
  // Through text, as the file is.
  const LoadedScenario again = read_scenario(parse_json(json_text(effective)), directory);
  EXPECT_EQ(json_text(effective_scenario(again.scenario, directory)), json_text(effective));
  for (const auto& [kind, pointer, text] : again.warnings) {
    EXPECT_TRUE(text.find("has no effect") != std::string::npos || text.ends_with("have no value")) << text;
  }
  EXPECT_EQ(content_hash(again.scenario), content_hash(scenario));
}

TEST(EffectiveScenario, OfEveryKindOfFieldIsAFixedPoint) {
  for (const auto& list : {test::minimal_scenarios(), test::rich_scenarios()}) {
    for (const test::NamedScenario& scenario : list) {
      SCOPED_TRACE(scenario.name);
      expect_fixed_point(read_scenario(scenario.json, test::data_directory()).scenario, test::data_directory());
    }
  }
}

TEST(ScenarioHash, FollowsTheContentsOfFilesNotTheirPaths) {
  const test::TemporaryDirectory directory;
  struct Case {
    const char *environment, *source, *more;
  };
  for (const Case& of : {Case{"point_shell", "shell.csv", "0,0,0,0,0,1\n"}, Case{"mesh", "cube.obj", "# more\n"}}) {
    const std::string end = fs::path(of.source).extension(),
                      contents = test::read_file(test::data_directory() / of.source);
    const auto hash_with = [&](const std::string& file, const std::string& text) {
      test::write_plainly(directory / (file + end), text);
      Json json = test::minimal_scenario(of.environment);
      json["environment"]["file"] = file + end;
      return content_hash(read_scenario(json, directory.path()).scenario);
    };
    const std::string hash = hash_with("a", contents);
    EXPECT_EQ(hash_with("b", contents), hash);
    EXPECT_NE(hash_with("b", contents + of.more), hash);
  }
}

}  // namespace
}  // namespace hapbench::fields_test
