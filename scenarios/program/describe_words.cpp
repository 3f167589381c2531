#include "scenarios/program/describe_words.hpp"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>

#include "results/summary/outcome_names.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

struct Word {
  std::string_view name;
  const char* kind;
  const char* meaning;
};

constexpr const char* kOutcome = "outcome of a run";
constexpr const char* kMotion = "class of motion, of limit and stability";
constexpr const char* kTime = "number of timing.json";
constexpr const char* kVerdict = "verdict on a claim";

constexpr Word kWords[] = {
    {"stable", kMotion, "at rest, died out or creeping"},
    {"dying_out", kMotion, "still oscillates, but comes to rest if the run goes on"},
    {"vibrating", kMotion, "oscillates and does not decay"},
    {"diverged", kMotion, "left its bounds, or oscillates with a growing amplitude"},
    {"thrown_out", kMotion,
     "the tool left the hole, or ended without contact beyond the environment's box by more than it reaches"},
    {"no_contact", kMotion, "the tool touched nothing in any row"},
    {"step_p50_s", kTime, "what half of the steps take at most, each by itself, without observers and recorders [s]"},
    {"step_p99_s", kTime, "what 99 % of the steps take at most, each by itself, without observers and recorders [s]"},
    {"reproduced", kVerdict, "the rule of the claim holds with the published numbers"},
    {"reproduced in kind", kVerdict, "direction or mechanism are the published ones, the numbers are not"},
    {"not reproduced", kVerdict, "neither, in this model of the device and the hand"},
    {"refuted", kVerdict, "it contradicts an exact result"},
    {"not reproducible", kVerdict, "no simulation can show it: people or the trainer are needed"},
};

/// Outcomes first.
std::vector<Word> all_words() {
  std::vector<Word> all;
  for (const OutcomeInfo& outcome : outcome_infos()) all.push_back({outcome.name, kOutcome, outcome.meaning});
  all.insert(all.end(), std::begin(kWords), std::end(kWords));
  return all;
}

/// In lower case, without blanks and line breaks.
std::string plain(std::string_view text) {
  std::string plain = lower_case(text);
  std::erase_if(plain, [](unsigned char c) { return std::isspace(c); });
  return plain;
}

}  // namespace

std::vector<Description> describe_word(const std::string& name) {
  std::vector<Description> found;
  for (const Word& word : all_words()) {
    if (name != word.name) continue;
    std::string text = fmt::format("{}: {}\n{}", bold(stdout, word.name), word.kind, wrapped(word.meaning));
    if (word.kind == kMotion) text += "  in numbers: hapbench describe stability\n";
    found.push_back({text, {{"kind", word.kind}, {"name", word.name}, {"meaning", word.meaning}}});
  }
  return found;
}

std::vector<Description> describe_heading(const std::string& name) {
  std::vector<Description> found;
  for (const RunHeading& heading : kRunHeadings) {
    const std::string_view title = heading.title, first = title.substr(0, title.find('\n'));
    if (plain(name) != plain(title) && plain(name) != plain(first)) continue;
    for (const char* shown : heading.shows) {
      if (shown == nullptr) continue;
      const std::vector<Description> results = describe_results(shown), words = describe_word(shown);
      found.push_back(results.empty() ? words.front() : results.front());  // of a metric, before columns
    }
  }
  return found;
}

std::vector<std::string> described_words() {
  std::vector<std::string> names;
  for (const Word& word : all_words()) names.emplace_back(word.name);
  return names;
}

}  // namespace hapbench
