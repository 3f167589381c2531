#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/describe.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// What people see: widths, manual page, completions, where the program finds its files.
namespace hapbench::terminal_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;

/// What the shell offers at the end of a command line; `words` as bash has broken them.
std::vector<std::string> offered(std::vector<std::string> words) {
  words.insert(words.begin(), "complete");
  return lines_of(hapbench(words).out);
}

bool holds(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::size_t widest(const std::string& text) {
  std::size_t most = 0;
  for (const std::string& line : lines_of(text)) most = std::max(most, line.size());
  return most;
}

ProgramRun in_terminal(const std::vector<std::string>& arguments, std::size_t columns) {
  test::ProgramOptions options;
  options.columns = columns;
  return hapbench(arguments, options);
}

TEST(Terminal, HasEveryHelpInItsWidth) {
  std::vector<std::string> commands = offered({""});
  ASSERT_GE(commands.size(), 17u);
  for (const std::string& command : commands) {
    EXPECT_LE(widest(in_terminal({command, "--help"}, 80).out), 80u) << command;
    EXPECT_LE(widest(hapbench({command, "--help"}).out), 100u) << command << ", in a pipe";
    EXPECT_EQ(hapbench({command, "--help"}).status, 0) << command;
  }
  EXPECT_LE(widest(in_terminal({"--help"}, 80).out), 80u);
}

TEST(Terminal, HasListsAndCardsInItsWidth) {
  for (const char* name : {"scenario", "hand", "environment", "device", "profile", "shaped_stiffness", "metrics",
                           "columns", "normal_projection", "leapfrog", "rendering.algorithm", "time", "force_max_N"}) {
    EXPECT_LE(widest(in_terminal({"describe", name}, 80).out), 80u) << name;
  }
  EXPECT_LE(widest(in_terminal({"list"}, 80).out), 80u);
  EXPECT_LE(widest(in_terminal({"new"}, 80).out), 80u);
}

TEST(Terminal, HasTablesInItsWidthOrInFull) {
  const test::TemporaryDirectory directory;
  const std::string out = "--out=" + (directory / "out").string();
  const std::vector<std::vector<std::string>> commands = {
      {"run", "peg_in_hole_2d_mean", "single_spring"},
      {"run", "peg_in_hole_2d_mean", "--latency"},
      {"compare", "peg_in_hole_2d_mean"},
      {"compare", "peg_in_hole_2d_mean", "single_spring"},
      {"stability", "single_spring"},
      {"limit", "single_spring", "--vary=rendering.stiffness_N_per_m"},
      {"sweep", "single_spring", "--vary=seed=1,2"},
      {"reproduce", "--only=A2"},
      {"validate", "peg_in_hole_2d_mean"}};
  for (std::vector<std::string> words : commands) {
    if (words[0] != "validate") words.push_back(out);
    const ProgramRun narrow = in_terminal(words, 80);
    EXPECT_EQ(narrow.status, 0) << words[0] << narrow.err;
    for (const std::string& line : lines_of(narrow.out)) {
      EXPECT_TRUE(line.size() <= 80u || line.find(' ', 2) == std::string::npos) << words[0] << ": " << line;
    }
  }
  const std::vector<std::string> list = {"list", "algorithms"}, wide = {"list", "algorithms", "--wide"};
  EXPECT_EQ(in_terminal(wide, 80).out, hapbench(list).out);
  EXPECT_NE(in_terminal(list, 80).out, hapbench(list).out);
}

TEST(Terminal, GetsNoControlCharactersThroughAPipe) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"--help"}, {"list"}, {"nonsense"}}) {
    const ProgramRun run = hapbench(words);
    EXPECT_EQ((run.out + run.err).find('\033'), std::string::npos) << words[0];
  }
}

// A field whose type has no summary would be listed without a word.
TEST(List, SaysWhatEverythingIs) {
  for (const Json& entry : hapbench({"list", "--json"}).json()) EXPECT_NE(entry["summary"], "") << entry;
}

TEST(List, ShowsWhatIsAskedFor) {
  EXPECT_NE(hapbench({"list", "scenarios", "--grep", "MOLAR"}).out.find("mesh_molar"), std::string::npos);
  EXPECT_EQ(hapbench({"list", "scenarios", "--grep", "MOLAR"}).out.find("poke_plane"), std::string::npos);
  EXPECT_EQ(hapbench({"list", "depth_models"}).out.find("algorithms"), std::string::npos);
  const ProgramRun wrong = hapbench({"list", "integratros"}), nothing = hapbench({"list", "--grep", "no such thing"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("nearest valid name: \"integrator\""), std::string::npos) << wrong.err;
  EXPECT_EQ(nothing.status, 2);
}

TEST(CommandWords, AreSuggestedWhenMisspelt) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"rnu", "single_spring"}, "unknown command \"rnu\"; nearest valid name: \"run\""},
      {{"help"}, "unknown command \"help\"; nearest valid name: \"--help\""},
      {{"version"}, "unknown command \"version\"; nearest valid name: \"--version\""},
      {{"compare", "single_spring", "--algorithm", "proxy"},
       "unknown option \"--algorithm\"; nearest valid name: \"--algorithms\""},
      {{"run", "single_spring", "--otu=x"}, "unknown option \"--otu\"; nearest valid name: \"--out\""},
      {{"stability", "single_spring", "--search", "--objective", "crated"}, "nearest valid name: \"created\""},
      {{}, "a command is missing"},
      {{"run"}, "run: scenarios is required"},
      {{"compare", "single_spring", "--jobs", "0"}, "--jobs: got 0; allowed: 1 ... 1024"}};
  for (const auto& [words, says] : cases) {
    const ProgramRun run = hapbench(words);
    EXPECT_EQ(run.status, 2) << says;
    EXPECT_EQ(run.err.find("hapbench: error: "), 0u) << run.err;
    EXPECT_EQ(lines_of(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
  }
}

TEST(Overrides, AreSuggestedWhenMisspelt) {
  for (const auto& [override, says] : {std::pair{"rendering.stifness=3", "nearest valid name: \"stiffness_N_per_m\""},
                                       std::pair{"stiffness=3", "\"rendering.stiffness_N_per_m\""},
                                       std::pair{"redering.iterations=1", "nearest valid name: \"rendering\""}}) {
    const ProgramRun run = hapbench({"run", "single_spring", "--set", override});
    EXPECT_EQ(run.status, 2);
    EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
  }
}

TEST(ScenarioFile, HasAllItsFaultsReportedAtOnce) {
  const test::TemporaryDirectory directory;
  Json json = test::minimal_scenario("plane");
  json["time"]["step_s"] = -1;
  json["environment"]["spacing_m"] = "fine";
  json["rendering"]["stifness_N_per_m"] = 1;
  test::write_plainly(directory / "a.json", json.dump());
  const std::string file = (directory / "a.json").string();
  const ProgramRun run = hapbench({"run", file});
  EXPECT_EQ(run.status, 2);
  const std::vector<std::string> lines = lines_of(run.err);
  ASSERT_EQ(lines.size(), 3u) << run.err;
  std::set<std::string> places;
  for (const std::string& line : lines) {
    const std::string begin = "hapbench: error: " + file + ": ";
    ASSERT_EQ(line.find(begin), 0u) << line;
    places.insert(line.substr(begin.size(), line.find(':', begin.size()) - begin.size()));
  }
  EXPECT_EQ(places, (std::set<std::string>{"/environment/spacing_m", "/rendering/stifness_N_per_m", "/time/step_s"}));
  EXPECT_EQ(hapbench({"validate", file, "--json"}).json()[0]["errors"].size(), 3u);
}

TEST(Completion, OffersCommandsOptionsNamesAndFields) {
  EXPECT_EQ(offered({"pre"}), std::vector<std::string>{"precision"});
  EXPECT_TRUE(holds(offered({"compare", "--alg"}), "--algorithms"));
  EXPECT_TRUE(holds(offered({"run", "peg_in"}), "peg_in_hole_2d_mean"));
  EXPECT_TRUE(holds(offered({"run", "single_spring", "peg_in"}), "peg_in_hole_2d_mean")) << "of several";
  EXPECT_TRUE(holds(offered({"compare", "x", "--algorithms", "mean,pro"}), "mean,proxy"));
  EXPECT_EQ(offered({"compare", "x", "--algorithms=mean,pro"}), std::vector<std::string>{"--algorithms=mean,proxy"});
  EXPECT_EQ(offered({"compare", "x", "--algorithms", "=", "prox"}), std::vector<std::string>{"proxy"})
      << "broken by bash";
  EXPECT_EQ(offered({"run", "x", "--set", "rendering.stiff"}),
            std::vector<std::string>{"rendering.stiffness_N_per_m="});
  EXPECT_EQ(offered({"run", "x", "--set", "rendering.algorithm", "=", "summ"}), std::vector<std::string>{"summation"});
  EXPECT_EQ(offered({"run", "x", "--set", "rendering.local_average", "="}),
            (std::vector<std::string>{"true", "false"}));
  EXPECT_EQ(offered({"describe", "continuous_"}), std::vector<std::string>{"continuous_normal_projection"});
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"run", "x", "--out", ""}, {"nonsense", ""}, {"describe", "mean", ""}}) {
    EXPECT_EQ(offered(words), std::vector<std::string>{}) << words[0];
  }
}

/// As bash itself asks for it: by the name that is found in PATH, and by a path with the backslashes it is typed with.
TEST(Completion, WorksInBash) {
  const test::TemporaryDirectory directory;
  const fs::path folder = directory / "a b'\xc3\xa4";
  fs::create_directory(folder);
  fs::create_symlink(test::hapbench_program(), folder / "hapbench");
  const std::string script = R"(PATH=$0:$PATH; source <(hapbench completion bash); complete -p hapbench
for name in hapbench "$1"; do
  COMP_WORDS=("$name" run peg_in_hole_2d_summ); COMP_CWORD=2; _hapbench "$name"
  printf '%s\n' "${COMPREPLY[@]}"
done)";
  const std::string typed = (directory / "a\\ b\\'\xc3\xa4/hapbench").string();
  const ProgramRun run = test::run_program("/bin/bash", {"--norc", "-c", script, folder.string(), typed});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(lines_of(run.out), (std::vector<std::string>{"complete -o default -F _hapbench hapbench",
                                                         "peg_in_hole_2d_summation", "peg_in_hole_2d_summation"}));
  EXPECT_EQ(run.err, "");
  EXPECT_TRUE(hapbench({"completion", "zsh"}).out.ends_with(hapbench({"completion", "bash"}).out));
  EXPECT_EQ(hapbench({"completion", "tcsh"}).status, 2);
}

TEST(ManualPage, HasEveryCommandAndIsTakenByManWithoutAWarning) {
  const std::string page = hapbench({"man"}).out;
  for (const std::string& command : offered({""}))
    EXPECT_NE(page.find("\n.SS " + command + "\n"), std::string::npos) << command;
  EXPECT_NE(page.find("\\fB\\-\\-algorithms\\fR"), std::string::npos);
  if (!fs::exists("/usr/bin/man")) GTEST_SKIP() << "no man here";
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "hapbench.1", page);
  const ProgramRun run = test::run_program("/usr/bin/man", {"--warnings", "-l", (directory / "hapbench.1").string()});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_NE(run.out.find("EXIT STATUS"), std::string::npos);
}

TEST(Version, HasAsJsonWhatMadeTheProgramAndWhatItPromises) {
  const Json version = hapbench({"--version", "--json"}).json();
  for (const char* key : {"version", "commit", "compiler", "instruction_set", "promise"})
    EXPECT_TRUE(version.contains(key)) << key;
  EXPECT_EQ(hapbench({"--version"}).out.find("hapbench " + version["version"].get<std::string>()), 0u);
  EXPECT_EQ(hapbench({"--json"}).status, 2);
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
  EXPECT_EQ(test::run_program(program, {"list"}).out, hapbench({"list"}).out);
  EXPECT_EQ(test::read_file(directory / "share/man/man1/hapbench.1"), hapbench({"man"}).out);
  EXPECT_EQ(test::read_file(directory / "share/bash-completion/completions/hapbench"),
            hapbench({"completion", "bash"}).out);
  const ProgramRun claim = test::run_program(program, {"reproduce", "--only", "A2", "--out", out});
  EXPECT_EQ(claim.status, 0) << claim.err;

  fs::remove_all(directory / "share");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"list"}, {"run", "single_spring", "--out", out}, {"reproduce", "--out", out}}) {
    const ProgramRun run = test::run_program(program, words);
    EXPECT_EQ(run.status, 2) << words[0];
    EXPECT_EQ(run.out, "") << words[0];
    EXPECT_EQ(lines_of(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find("share/hapbench/"), std::string::npos) << run.err;
  }
  EXPECT_EQ(test::run_program(program, {"describe", "mean"}).status, 0) << "needs no folder";
}

}  // namespace
}  // namespace hapbench::terminal_test
