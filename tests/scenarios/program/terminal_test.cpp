#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "algorithms/registry.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/json_schema.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/commands.hpp"
#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/profiles.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "scenarios/thesis/claims.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::terminal_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::hapbench_in_process;
using test::lines_of;
using test::ProgramRun;

// Tests the program at a terminal: lists, descriptions and completion, the folders of results, and the search for
// installed files.

/// Returns the names of the commands, which the program prints after the names of their groups.
std::vector<std::string> command_names() {
  const std::vector<std::string> lines = lines_of(hapbench({}).out);
  std::vector<std::string> names;
  for (std::size_t i = 2; i < lines.size() && !lines[i].empty(); ++i)
    names.push_back(lines[i].substr(8, lines[i].find(' ', 8) - 8));
  return names;
}

std::size_t widest(const std::string& text) {
  std::size_t longest = 0;
  for (const std::string& line : lines_of(text)) longest = std::max(longest, line.size());
  return longest;
}

ProgramRun in_terminal(const std::vector<std::string>& arguments, std::size_t columns) {
  test::ProgramOptions options;
  options.columns = columns;
  return hapbench(arguments, options);
}

TEST(Terminal, BeginsWithTheCommandsOnOnePage) {
  const ProgramRun run = in_terminal({}, 80);
  EXPECT_EQ(run.status, 0);
  EXPECT_LE(lines_of(run.out).size(), 24u);
  EXPECT_LE(widest(run.out), 80u);
}

TEST(Terminal, HasEveryHelpInItsWidth) {
  std::vector<std::string> commands = command_names();
  ASSERT_EQ(commands.size(), 15u);
  for (const std::string& command : commands) {
    const ProgramRun help = in_terminal({command, "--help"}, 80);
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_LE(widest(help.out), 80u) << command;
    EXPECT_LE(widest(hapbench({command, "--help"}).out), 100u) << command << ", in a pipe";
  }
  EXPECT_LE(widest(in_terminal({"--help"}, 80).out), 80u);
}

/// Returns the lines between a heading of a text and the next empty line; empty without this heading.
std::vector<std::string> lines_below(const std::string& text, const std::string& heading) {
  const std::vector<std::string> lines = lines_of(text);
  const auto begin = std::find(lines.begin(), lines.end(), heading);
  if (begin == lines.end()) return {};
  return {begin + 1, std::find(begin, lines.end(), "")};
}

TEST(Terminal, ListsNoOptionOfACommandAsOneOfTheProgram) {
  const std::string help = hapbench({"--help"}).out;
  std::size_t options = 0;
  for (const std::string& line : lines_below(help, "Options without a command:")) {
    const std::string option = line.substr(2, line.find(' ', 2) - 2);
    if (!option.starts_with("--")) continue;  // this line continues the meaning of the option above
    EXPECT_EQ(hapbench({option}).status, 0) << option;
    ++options;
  }
  EXPECT_GE(options, 2u);
  EXPECT_EQ(hapbench({"--json"}).status, 2);
  const std::string shared = "Options that commands share, written after the command's name:";
  EXPECT_GE(lines_below(help, shared).size(), 9u);
}

/// Returns true if the help of a command lists an option: by name and placeholder in a line of its own, or by name in
/// the line of shared options, which begins with --help.
bool lists_option(const std::string& help, const std::string& name, const std::string& placeholder) {
  for (const std::string& line : lines_of(help)) {
    if ((line + " ").starts_with("  " + name + (placeholder.empty() ? "" : " ") + placeholder + " ")) return true;
    if (line.starts_with("  --help") && std::regex_search(line, std::regex("[ ,]" + name + "(,| |$)"))) return true;
  }
  return false;
}

TEST(Terminal, NamesTheCommandsThatHaveASharedOption) {
  std::map<std::string, std::string> helps;
  for (const std::string& command : command_names())
    helps[command] =
        command == "import" ? hapbench({"import", "stroke", "--help"}).out : hapbench({command, "--help"}).out;
  std::string shared;
  for (const std::string& line :
       lines_below(hapbench({"--help"}).out, "Options that commands share, written after the command's name:"))
    shared += line.starts_with("    --") ? "\n" + line : line.substr(line.find_first_not_of(' ') - 1);
  // Each entry has a name, a placeholder, a meaning, and the commands that have or do not have the option.
  static const std::regex kEntry(R"(\n    (--[a-z-]+) ?(<[^>]*>)? [^\n]*?(?: \((not )?in: ([a-z, ]+)\))?(?=\n|$))");
  std::size_t entries = 0;
  for (std::sregex_iterator entry(shared.begin(), shared.end(), kEntry), end; entry != end; ++entry, ++entries) {
    const bool names_others = !(*entry)[4].matched || (*entry)[3].matched;
    const std::string named = ", " + (*entry)[4].str() + ",";
    for (const auto& [command, help] : helps) {
      const bool is_named = named.find(" " + command + ",") != std::string::npos;
      EXPECT_EQ(lists_option(help, (*entry)[1], (*entry)[2]), is_named != names_others) << command << (*entry)[0];
    }
  }
  EXPECT_EQ(entries, 11u);
}

/// Checks that there are at most 85 option names, because users could not remember more.
TEST(Terminal, HasNoMoreThanEightyFiveNamesOfOptions) {
  static const std::regex kNames("\n  (--[a-z-]+(, --[a-z-]+)*)"), kName("--[a-z-]+");
  std::set<std::string> names;
  std::vector<std::string> helps = {hapbench({"--help"}).out};
  for (const char* kind : {"stroke", "device"}) helps.push_back(hapbench({"import", kind, "--help"}).out);
  for (const std::string& command : command_names()) helps.push_back(hapbench({command, "--help"}).out);
  for (const std::string& help : helps) {
    for (std::sregex_iterator line(help.begin(), help.end(), kNames), end; line != end; ++line) {
      const std::string found = (*line)[1];
      names.insert(std::sregex_token_iterator(found.begin(), found.end(), kName), std::sregex_token_iterator());
    }
  }
  EXPECT_GT(names.size(), 60u);
  EXPECT_LE(names.size(), 85u);
}

TEST(Terminal, HasListsAndCardsInItsWidth) {
  for (const char* name : {"scenario", "hand", "environment", "device", "profile", "shaped_stiffness", "metrics",
                           "columns", "normal_projection", "leapfrog", "rendering.algorithm", "time", "force_max_N"}) {
    EXPECT_LE(widest(in_terminal({"describe", name}, 80).out), 80u) << name;
  }
  EXPECT_LE(widest(in_terminal({"describe"}, 80).out), 80u);
  EXPECT_LE(widest(in_terminal({"new"}, 80).out), 80u);
  const std::vector<std::string> list = {"describe", "algorithms"}, wide = {"describe", "algorithms", "--wide"};
  EXPECT_EQ(in_terminal(wide, 80).out, hapbench(list).out);
  EXPECT_NE(in_terminal(list, 80).out, hapbench(list).out);
}

std::string completion_script() {
  return test::run_program(HAPBENCH_SCENARIOS "/../../scripts/completion", {test::hapbench_program().string()}).out;
}

/// Checks the completion by calling it as bash does.
TEST(Completion, KnowsEveryCommandAndItsOptionsInBash) {
  const std::string script = completion_script() + R"(
complete -p hapbench
COMP_WORDS=(hapbench); COMP_CWORD=1; _hapbench; printf '%s\n' "${COMPREPLY[@]}"
COMP_WORDS=(hapbench run --lat); COMP_CWORD=2; _hapbench; printf '%s\n' "${COMPREPLY[@]}")";
  const ProgramRun run = test::run_program("/bin/bash", {"--norc", "-c", script});
  EXPECT_EQ(run.err, "");
  const std::vector<std::string> offered = lines_of(run.out);
  EXPECT_EQ(offered.front(), "complete -o default -F _hapbench hapbench");
  EXPECT_EQ(offered.back(), "--latency");
  for (const std::string& command : command_names())
    EXPECT_NE(std::find(offered.begin(), offered.end(), command), offered.end()) << command;
}

TEST(Installation, HasItsScenariosBesideTheProgramAndMissesThemAloud) {
  const test::TemporaryDirectory directory;
  const ProgramRun install =
      test::run_program(HAPBENCH_CMAKE, {"--install", HAPBENCH_BUILD_DIR, "--prefix", directory.path().string()});
  ASSERT_EQ(install.status, 0) << install.err;
  const fs::path program = directory / "bin/hapbench";
  const std::string out = (directory / "out").string();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"validate", "peg_in_hole_2d_mean"}, {"validate", "gradient_flip"}, {"validate", "mesh_molar"}}) {
    const ProgramRun run = test::run_program(program, words);
    EXPECT_EQ(run.status, 0) << run.err;
  }
  EXPECT_EQ(test::run_program(program, {"describe"}).out, hapbench({"describe"}).out);
  EXPECT_EQ(test::read_file(directory / "share/bash-completion/completions/hapbench"), completion_script());
  const ProgramRun claim = test::run_program(program, {"reproduce", "--only", "A2", "--out", out});
  EXPECT_EQ(claim.status, 0) << claim.err;

  fs::remove_all(directory / "share");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"describe"}, {"run", "single_spring", "--out", out}, {"reproduce", "--out", out}}) {
    const ProgramRun run = test::run_program(program, words);
    EXPECT_EQ(run.status, 2) << words[0];
    EXPECT_EQ(run.out, "") << words[0];
    EXPECT_EQ(lines_of(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find("share/hapbench/"), std::string::npos) << run.err;
  }
  EXPECT_EQ(test::run_program(program, {"describe", "mean"}).status, 0) << "needs no folder";
}

TEST(DescribeCommand, ExplainsEveryNameThereIs) {
  std::set<std::string> listed;
  for (const Json& entry : hapbench_in_process({"describe", "--json"}).json()) {
    EXPECT_NE(entry["summary"], "") << entry;  // without a summary, a list would print only the name of the entry
    listed.insert(entry["name"].get<std::string>());
  }
  std::vector<std::string> models;
  for (const AlgorithmEntry& entry : algorithms()) models.emplace_back(entry.info->name);
  for (const DepthModelEntry& entry : depth_models()) models.emplace_back(entry.info->name);
  for (const IntegratorEntry* integrator : kIntegrators) models.emplace_back(integrator->info.name);
  for (const ScenarioField& placed : scenario_fields())
    if (placed.path == "environment")
      for (const ValueGuide& type : placed.field->value.choices) models.push_back(type.type);
  for (const BundledScenario& bundled : bundled_scenarios()) models.push_back(bundled.name);
  for (const std::string& name : models) EXPECT_TRUE(listed.contains(name)) << name;
  std::vector<std::string> names = scenario_field_paths();
  // The metrics are added below, without the prefix "expect.metrics.".
  std::erase_if(names, [](const std::string& path) { return path.starts_with("expect.metrics."); });
  for (const Metric& metric : metrics_without_values(1)) names.push_back(metric.name);
  for (const Claim& claim : all_claims()) names.emplace_back(claim.id);
  names.insert(names.end(), listed.begin(), listed.end());
  for (const std::string& name : names) {
    const ProgramRun run = hapbench_in_process({"describe", name});
    EXPECT_EQ(run.status, 0) << name << run.err;
    EXPECT_EQ(run.err, "") << name;
    EXPECT_NE(run.out.find(name), std::string::npos) << run.out;
  }
}

TEST(DescribeCommand, ExplainsTheWordsAndHeadingsThatResultsHave) {
  std::vector<std::string> words = {"qualitatively replicated", "tolerances", "limit_tolerance"};
  for (const OutcomeInfo& outcome : outcome_infos()) words.emplace_back(outcome.name);
  for (const RunVerdictText& verdict : run_verdict_texts()) words.emplace_back(verdict.name);
  for (const RunHeading& heading : kRunHeadings) words.emplace_back(heading.title);
  for (const std::string& word : words) EXPECT_EQ(hapbench_in_process({"describe", word}).status, 0) << word;
}

/// Adds the keys of all objects in `json` to `keys`.
void add_keys(const Json& json, std::set<std::string>& keys) {
  for (const auto& [key, value] : json.items()) {
    if (json.is_object()) keys.insert(key);
    if (value.is_structured()) add_keys(value, keys);
  }
}

TEST(DescribeCommand, ExplainsEveryKeyOfTheJsonFilesOfARun) {
  const test::TemporaryDirectory folder;
  std::set<std::string> keys;
  for (const char* scenario : {"drag_molar", "six_dof_peg", "impedance_in_hole", "task2_held", "hole_late"}) {
    const fs::path out = folder / scenario;
    const ProgramRun run =
        hapbench_in_process({"run", scenario, "--set", "record.timing=true", "--out", out.string(), "--quiet"});
    ASSERT_EQ(run.status, 0) << run.err;
    for (const char* file : {"summary.json", "timing.json"}) add_keys(read_json(out / file), keys);
  }
  EXPECT_GT(keys.size(), 150u);
  for (const IndexEntry& entry : program_index(Layout())) keys.erase(entry.name);
  // The remaining keys are the last parts of names, such as "created_sum_J" of the metric "energy.created_sum_J".
  for (const std::string& key : keys) EXPECT_EQ(hapbench_in_process({"describe", key}).status, 0) << key;
}

TEST(DescribeCommand, ExplainsEveryCommand) {
  for (const CommandGuide& guide : command_guides()) {
    const std::string name(guide.name);
    const ProgramRun run = hapbench_in_process({"describe", name});
    EXPECT_EQ(run.status, 0) << name << run.err;
    EXPECT_NE(run.out.find("hapbench " + name + " --help"), std::string::npos) << run.out;
  }
}

TEST(DescribeCommand, ShowsWhatNamesALocationInTheThesis) {
  const auto claims = [](const char* name) {
    return hapbench_in_process({"describe", name, "--json"}).json()["claims"];
  };
  for (const char* name : {"Fig. A.2", "fig a.2", "figure_A.2", "figure_A.2_springs.svg"})
    EXPECT_EQ(claims(name), Json::array({"A1"})) << name;
  // Section A.2 is about the springs, and Fig. 2 has the parts 2c and 2d.
  EXPECT_EQ(claims("section A.2"), Json::array({"A2", "A3"}));
  EXPECT_EQ(claims("A.2"), Json::array({"A1", "A2", "A3", "D2", "D7"}));
  EXPECT_EQ(claims("Fig. 2"), Json::array({"V1", "V2", "S3", "S1"}));
}

/// Checks every figure, table and equation that the thesis prints. Two tables have the same number.
TEST(DescribeCommand, ExplainsEveryNumberThatTheThesisPrints) {
  const Json locations =
      read_json(fs::path(HAPBENCH_SCENARIOS) / "../../results/reference/thesis_places.json").at("places");
  EXPECT_GT(locations.size(), 70u);
  for (const Json& location : locations) {
    const std::string name = location.at("place").get<std::string>();
    const ProgramRun run = hapbench_in_process({"describe", name, "--json"});
    ASSERT_EQ(run.status, 0) << name << run.err;
    const Json contents = run.json()["contents"];
    EXPECT_NE(std::ranges::find(contents, location), contents.end()) << name;
  }
  EXPECT_EQ(hapbench_in_process({"describe", "Table A. 1", "--json"}).json()["contents"].size(), 2u);
  for (const char* name : {"Eq. (4)", "eq 4", "equation 4", "Fig. F4"})
    EXPECT_EQ(hapbench_in_process({"describe", name, "--json"}).json()["contents"].size(), 1u) << name;
  EXPECT_EQ(hapbench_in_process({"describe", "Fig. 99"}).status, 2);
}

TEST(DescribeCommand, ListsAssumptionsAndTheClaimsThatEachDecides) {
  const std::string list = hapbench_in_process({"describe", "assumptions"}).out;
  EXPECT_NE(list.find("local.average"), std::string::npos) << list;
  const Json claims = read_json(fs::path(HAPBENCH_SCENARIOS) / "../../results/reference/claims.json").at("claims");
  const std::string text = hapbench_in_process({"describe", "local.average"}).out;
  const std::size_t decides = text.find("decides");
  ASSERT_NE(decides, std::string::npos) << text;
  for (const Json& claim : claims) {
    const auto deciders = claim.at("deciders").get<std::vector<std::string>>();
    if (std::ranges::find(deciders, "local.average") == deciders.end()) continue;
    EXPECT_NE(text.find(claim.at("id").get<std::string>(), decides), std::string::npos) << text;
  }
  // The error for a name of an earlier version states the new name.
  EXPECT_NE(hapbench_in_process({"describe", "choices"}).err.find("renamed it to \"assumptions\""), std::string::npos);
}

/// Checks the columns of all tables that a run can write.
TEST(DescribeCommand, ExplainsEveryColumnOfEveryFileOfARun) {
  const test::TemporaryDirectory directory;
  Json json = test::minimal_scenario("block_with_hole");
  json["initial"]["position_m"] = {0.003, 0.0, 0.0};  // on the flat face
  json["record"] = {{"contacts", true}, {"stiffness_tensor", true}, {"energy", true}, {"ideal_trajectory", true},
                    {"pose", true},     {"torque", true},           {"inside", true}, {"ratio_iterations", {3}}};
  test::write_plainly(directory / "a.json", json.dump());
  const std::string out = (directory / "out").string();
  ASSERT_EQ(hapbench({"run", (directory / "a.json").string(), "--out", out}).status, 0);
  const Json columns = Json::parse(test::read_file(directory / "out/columns.json"));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    if (entry.path().extension() != ".csv") continue;
    const std::string file = entry.path().filename().string();
    std::string header;
    for (const Json& column : columns.at(file)) {
      header += (header.empty() ? "" : ",") + column["name"].get<std::string>();
      const ProgramRun run = hapbench_in_process({"describe", column["name"].get<std::string>()});
      EXPECT_NE(run.out.find(file), std::string::npos) << column << run.out << run.err;
    }
    EXPECT_EQ(lines_of(test::read_file(entry.path()))[0], header) << file;
    EXPECT_EQ(hapbench_in_process({"describe", file, "--json"}).json()["columns"], columns[file]) << file;
    ++files;
  }
  EXPECT_EQ(files, 7u);
  const Json metrics = Json::parse(test::read_file(directory / "out/summary.json"))["metrics"];
  for (const auto& [name, value] : metrics.items()) {
    if (name == "final_position_m") continue;
    EXPECT_NE(columns["summary.json"].dump().find("\"" + name + "\""), std::string::npos) << name;
  }
}

/// Fixture of tests of the option --out and of the folders of results.
class OutputDirectory : public testing::Test {
 protected:
  static std::vector<std::vector<std::string>> commands_writing_to(const fs::path& out) {
    return {{"run", "single_spring", "--out", out.string()},
            {"run", "single_spring", "single_damper", "--out", out.string()},
            {"compare", "single_spring", "--algorithms", "mean", "--out", out.string()},
            {"sweep", "single_spring", "--vary", "seed=1,2", "--out", out.string()},
            {"validate", "peg_in_hole_2d_mean", "--points", (out / "s.csv").string()}};
  }
  static void expect_all_refused(const fs::path& out, const test::ProgramOptions& options = {}) {
    for (const auto& arguments : commands_writing_to(out)) {
      const ProgramRun run = hapbench(arguments, options);
      EXPECT_EQ(run.status, 2) << arguments[0] << " " << run.err;
      EXPECT_EQ(run.out, "") << arguments[0];
      EXPECT_EQ(test::lines_of(run.err).size(), 1u) << run.err;
      EXPECT_NE(run.err.find(out.string()), std::string::npos) << run.err;
    }
  }
  test::TemporaryDirectory directory_;
};

TEST_F(OutputDirectory, WhereNothingCanBeWrittenIsRefused) {
  test::write_plainly(directory_ / "file", "mine");
  for (const fs::path& out : {directory_ / "file", directory_ / "file/below", directory_ / std::string(300, 'd'),
                              fs::path("/proc/hapbench_cannot_write_here")})
    expect_all_refused(out);
  EXPECT_EQ(test::read_file(directory_ / "file"), "mine");
}

TEST_F(OutputDirectory, WithoutPermissionIsRefused) {
  fs::create_directory(directory_ / "locked");
  ::chmod((directory_ / "locked").c_str(), 0555);
  test::ProgramOptions options;
  options.as_root_may = false;
  if (hapbench({"describe"}, options).status == 126) GTEST_SKIP() << "root's privileges cannot be dropped here";
  expect_all_refused(directory_ / "locked", options);
  expect_all_refused(directory_ / "locked/below", options);
  EXPECT_TRUE(fs::is_empty(directory_ / "locked"));
}

TEST(InputDirectory, WithoutPermissionIsNamed) {
  const test::TemporaryDirectory directory;
  fs::create_directory(directory / "locked");
  ::chmod((directory / "locked").c_str(), 0000);
  test::ProgramOptions options;
  options.as_root_may = false;
  if (hapbench({"describe"}, options).status == 126) GTEST_SKIP() << "root's privileges cannot be dropped here";
  const std::string file = directory / "locked/a.json";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", file}, {"describe", file}, {"new", "mesh", "--from", file}}) {
    const ProgramRun run = hapbench(arguments, options);
    EXPECT_EQ(run.status, 2) << arguments[0];
    EXPECT_NE(run.err.find("cannot be read: Permission denied"), std::string::npos) << arguments[0] << run.err;
  }
}

TEST_F(OutputDirectory, MayHaveSpacesQuotesAndLetters) {
  const fs::path out = directory_ / "a b/c'd\"e/\xc3\xa4$HOME;x";
  for (const auto& arguments : commands_writing_to(out)) {
    const ProgramRun run = hapbench(arguments);
    EXPECT_EQ(run.status, 0) << arguments[0] << run.err;
  }
  EXPECT_TRUE(fs::exists(out / "s.csv"));
}

// Checks that `describe` explains the headings of printed tables, and that tables are at most as wide as the terminal.

using Words = std::vector<std::string>;

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// Adds the titles of a table's columns to `titles`. `rule` is the line of dashes below the titles, `lower` the line
/// above `rule`, and `upper` the line above `lower`. The title of a column has one line (lower) or two lines.
void add_titles(const std::string& upper, const std::string& lower, const std::string& rule,
                std::set<std::pair<std::string, std::string>>& titles) {
  static const std::regex kColumn("-+");
  for (std::sregex_iterator column(rule.begin(), rule.end(), kColumn), end; column != end; ++column) {
    const auto at = static_cast<std::size_t>(column->position()), wide = static_cast<std::size_t>(column->length());
    const auto part = [&](const std::string& line) { return at < line.size() ? trimmed(line.substr(at, wide)) : ""; };
    // A sweep of two fields prints values of a field above its columns; skip these.
    if (!finite_number(part(lower))) titles.emplace(part(upper), part(lower));
  }
}

std::set<std::pair<std::string, std::string>> titles_in(const std::string& text) {
  static const std::regex kRule(" *-+( +-+)*");
  std::set<std::pair<std::string, std::string>> titles;
  const std::vector<std::string> lines = test::lines_of(text);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (std::regex_match(lines[i], kRule)) add_titles(i > 1 ? lines[i - 2] : "", lines[i - 1], lines[i], titles);
  }
  return titles;
}

bool is_described(const std::string& name) {
  return test::hapbench_in_process({"describe", name}).status == 0;
}

/// Returns true if `describe` explains the title of a column. A title of two lines is one name, or the name of a scene
/// above the name of an algorithm. A title of one line may hold two names, separated by " \ ".
bool is_described(const std::string& upper, const std::string& lower) {
  if (upper.empty()) {
    const std::size_t slash = lower.find(" \\ ");
    return slash == std::string::npos ? is_described(lower)
                                      : is_described(lower.substr(0, slash)) && is_described(lower.substr(slash + 3));
  }
  return is_described(upper + lower) || is_described(upper + " " + lower) ||
         (is_described(upper) && is_described(lower));
}

TEST(Headings, OfEveryTableAreKnownToDescribeAndFitATerminal) {
  const test::TemporaryDirectory directory;
  test::ProgramOptions options;
  options.directory = directory.path();
  options.columns = 80;
  const std::vector<Words> commands = {
      {"run", "springs_limited_mean", "--latency", "--out", "a"},
      {"run", "springs_limited_mean", "--set", "rendering.stiffness_N_per_m=1e4", "--set", "expect={}", "--out", "b"},
      {"run", "vertical_peg_in_hole_shaped_stiffness", "--set", "hand.trials=1", "--set", "hand.task.time_limit_s=1",
       "--set", "hand.task.targets_per_place=1", "--set", "expect={}"},
      {"compare", "springs_limited_mean", "--algorithms", "mean,summation", "--out", "c"},
      {"compare", "recorded_wipe", "--algorithms", "mean,summation"},
      {"compare", "springs_limited_mean", "--algorithms", "mean,summation", "--seeds", "2"},
      {"compare", "springs_limited_mean", "springs_limited_summation", "--algorithms", "mean,summation"},
      {"limit", "tap_wall", "--device", "touch,ideal", "--set", "time.steps=200", "--resolution", "0.5"},
      {"limit", "single_spring", "--vary", "rendering.stiffness_N_per_m", "--resolution", "0.5"},
      {"limit", "single_spring", "--vary", "rendering.mass_kg", "--smallest", "--resolution", "0.5"},
      {"sweep", "springs_limited_mean", "--vary", "rendering.mass_kg=0.1,0.2", "--set", "expect={}"},
      {"sweep", "springs_limited_mean", "--vary", "rendering.mass_kg=0.1,0.2", "--vary", "time.steps=100,200", "--set",
       "expect={}"},
      {"sweep", "springs_limited_mean", "--vary", "rendering.mass_kg=0.1:0.2", "--vary", "seed=1,2", "--vary",
       "rendering.stiffness_N_per_m=1e4:2e4:log", "--sample", "lhs:4", "--set", "expect={}", "--out", "s"},
      {"converge", "springs_oscillation", "--metric", "force_max_N,final_position_m.x", "--levels", "3"},
      {"compare", "springs_oscillation", "--errors", "--algorithms", "mean,summation", "--out", "g"},
      {"tune", "single_spring"},
      {"stress", "--count", "10"},
      {"reproduce", "--only", "R2"}};
  std::set<std::pair<std::string, std::string>> titles;
  for (const Words& words : commands) {
    const test::ProgramRun run = test::hapbench(words, options);
    EXPECT_TRUE(run.status == 0 || run.status == 3) << words[0] << " " << words[1] << ": " << run.err;
    const auto found = titles_in(run.out);
    EXPECT_FALSE(found.empty()) << words[0] << " " << words[1] << " prints no table:\n" << run.out;
    titles.insert(found.begin(), found.end());
    for (const std::string& line : test::lines_of(run.out))  // a path may be longer
      EXPECT_TRUE(line.size() <= 80u || line.find(' ', 2) == std::string::npos) << words[0] << ": " << line;
  }
  for (const auto& file : std::filesystem::recursive_directory_iterator(directory.path())) {
    const std::string name = file.path().filename().string();
    // The scenario that `tune` writes is not a result.
    if (!file.is_regular_file() || name.ends_with("_tuned.json")) continue;
    EXPECT_TRUE(is_described(name)) << file.path();
  }
  EXPECT_GT(titles.size(), 70u);
  for (const auto& [upper, lower] : titles) EXPECT_TRUE(is_described(upper, lower)) << upper << " / " << lower;
}

/// Checks all headings, including headings of tables that no command above prints.
TEST(Headings, OfEveryListHaveAMeaning) {
  for (const DescribedTable& table : result_tables())
    for (const Table::Column& heading : table.headings) EXPECT_TRUE(is_described(heading.title)) << heading.title;
}

TEST(Words, OfTheOutputsAreKnownToDescribe) {
  for (const char* word : {"ranking.csv", "sweep.json", "quantum", "planar.first_tilt"})
    EXPECT_TRUE(is_described(word)) << word;
}

}  // namespace
}  // namespace hapbench::terminal_test
