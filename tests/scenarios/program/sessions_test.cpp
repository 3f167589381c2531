#include <gtest/gtest.h>
#include <wordexp.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Compares the output of the program hapbench with stored sessions at a terminal: tests/data/golden/*.txt. A session
/// starts in a folder with cube.obj, shell.csv and stroke.csv. Its lines are
///
///     # a comment
///     + NAME TEXT             writes the file NAME; "\n" in the text ends a line
///     $ hapbench WORDS…       runs the program, with the words split and expanded by the rules of a shell
///     $ keys hapbench WORDS…  runs the program, and replaces JSON on standard output by the sorted paths of its keys
///     $ ls                    lists the files of the session
///
/// The lines after a command hold its output: standard output after two blanks, standard error after "! ", and an exit
/// status other than 0 after "= ". After a change of the program's texts, this command updates the stored output. Read
/// the changes as a diff before you commit them:
///
///     HAPBENCH_RENEW_GOLDEN=1 build/release/bin/program_test --gtest_filter='*Sessions*'
namespace hapbench::sessions_test {
namespace {

namespace fs = std::filesystem;

const fs::path kGolden = test::data_directory() / "golden";
const std::vector<std::string> kGiven = {"cube.obj", "shell.csv", "stroke.csv"};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::vector<std::string> words_of(const std::string& line) {
  wordexp_t expanded{};
  if (::wordexp(line.c_str(), &expanded, WRDE_NOCMD | WRDE_UNDEF) != 0)
    throw std::invalid_argument("no words: " + line);
  std::vector<std::string> words(expanded.we_wordv, expanded.we_wordv + expanded.we_wordc);
  ::wordfree(&expanded);
  return words;
}

/// Returns the text with `mark` written before each line, and without blanks at the ends of the lines.
std::string marked(const std::string& text, const std::string& mark) {
  std::string result;
  for (const std::string& line : test::lines_of(text)) {
    const std::string whole = mark + line;
    result += whole.substr(0, whole.find_last_not_of(' ') + 1) + "\n";
  }
  return result;
}

/// Adds the paths of all values below `json`, such as "rows[].value". Programs that read the JSON rely on these paths.
void add_keys(const Json& json, const std::string& path, std::set<std::string>& keys) {
  if (json.empty() || !json.is_structured()) keys.insert(path);
  for (const auto& [key, value] : json.items())
    if (json.is_array()) {
      add_keys(value, path + "[]", keys);
    } else if (json.is_object()) {
      add_keys(value, path.empty() ? key : path + "." + key, keys);
    }
}

std::string keys_of(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return text;
  std::set<std::string> keys;
  add_keys(json, "", keys);
  std::string lines;
  for (const std::string& key : keys) lines += key + "\n";
  return lines;
}

/// Runs the commands of a session file with the compiled program, in a temporary folder, and records their output.
class Session {
 public:
  Session() {
    for (const std::string& name : kGiven) fs::copy_file(test::data_directory() / name, directory_ / name);
  }

  std::string played(const std::string& script) const {
    std::string session;
    for (const std::string& line : test::lines_of(script)) {
      const char kind = line.empty() ? ' ' : line[0];
      if (kind == '#' || kind == '+' || kind == '$') session += line + "\n";
      if (kind == '+') write(line);
      if (kind == '$') session += answer(words_of(line.substr(2)));
    }
    return session;
  }

 private:
  void write(const std::string& line) const {
    const std::size_t end = std::min(line.find(' ', 2), line.size());
    const fs::path file = directory_ / line.substr(2, end - 2);
    fs::create_directories(file.parent_path());
    test::write_plainly(file, replaced(line.substr(std::min(end + 1, line.size())), "\\n", "\n"));
  }

  std::string answer(const std::vector<std::string>& words) const {
    if (words.at(0) == "ls") {
      std::string names;
      for (const std::string& name : test::names_below(directory_.path())) {
        if (std::find(kGiven.begin(), kGiven.end(), name) == kGiven.end()) names += name + "\n";
      }
      return marked(names, "  ");
    }
    test::ProgramOptions options;
    options.directory = directory_.path();
    const bool keys = words.at(0) == "keys";
    const test::ProgramRun run = test::hapbench({words.begin() + (keys ? 2 : 1), words.end()}, options);
    return marked(without_paths(keys ? keys_of(run.out) : run.out), "  ") + marked(without_paths(run.err), "! ") +
           (run.status == 0 ? "" : "= " + std::to_string(run.status) + "\n");
  }

  std::string without_paths(std::string text) const {
    text = replaced(std::move(text), directory_.path().string(), "<here>");
    text = replaced(std::move(text), fs::canonical(test::hapbench_program()).string(), "<program>");
    text = replaced(std::move(text), fs::canonical(HAPBENCH_SCENARIOS).string(), "<scenarios>");
    return replaced(std::move(text), fs::canonical(HAPBENCH_SCENARIOS "/../../results").string(), "<results>");
  }

  test::TemporaryDirectory directory_;
};

std::vector<std::string> session_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kGolden)) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class Sessions : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Golden, Sessions, testing::ValuesIn(session_names()),
                         [](const auto& name) { return name.param; });

TEST_P(Sessions, GoAsTheyDid) {
  const fs::path file = kGolden / (GetParam() + ".txt");
  const std::string before = test::read_file(file), now = Session().played(before);
  if (std::getenv("HAPBENCH_RENEW_GOLDEN") != nullptr) {
    test::write_plainly(file, now);
  } else if (now != before) {
    const test::TemporaryDirectory directory;
    test::write_plainly(directory / "now", now);
    ADD_FAILURE() << test::run_program("/usr/bin/diff", {"-u", file.string(), (directory / "now").string()}).out
                  << "HAPBENCH_RENEW_GOLDEN=1 renews " << file;
  }
}

}  // namespace
}  // namespace hapbench::sessions_test
