#include "scenarios/program/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/io/columns.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/json_file.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAsk = "ask";
/// What is said of a study, and is not an option of its command.
constexpr const char* kNoOptions[] = {kAsk, "scenarios", "summary", "source", "alone", "$schema"};

fs::path studies_folder() {
  return installed_folder("scenarios/library") / "studies";
}

struct StudyFile {
  fs::path file;
  std::string text;
};

/// The study that a word names, or whose file it is; none for anything else, and for what cannot be read: a command
/// refuses that with its place.
std::optional<StudyFile> find_study(const std::string& word) {
  std::error_code error;
  try {
    fs::path file = word;
    if (!word.ends_with(".json") || !fs::is_regular_file(word, error)) {
      if (word.empty() || word.find('/') != std::string::npos || fs::exists(word, error)) return std::nullopt;
      file = studies_folder() / (word + ".json");
      if (!fs::exists(file, error)) return std::nullopt;
    }
    std::string text = read_text_file(file, kLargestJsonFile);
    if (text.find("\"ask\"") == std::string::npos) return std::nullopt;
    return StudyFile{file, std::move(text)};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return cell_text(value.get<double>());
  return value.dump();
}

std::string values_text(const Json& values) {
  if (values.is_object() && values.contains("from")) {
    const std::string count = values.contains("count") ? ":" + text_of(values["count"]) : "";
    return fmt::format("{}:{}{}{}", text_of(values.at("from")), text_of(values.value("to", Json())), count,
                       values.value("log", false) ? ":log" : "");
  }
  if (!values.is_array()) return text_of(values);
  std::vector<std::string> texts;
  for (const Json& value : values) texts.push_back(text_of(value));
  return fmt::format("{}", fmt::join(texts, ","));
}

/// The words for a key of a study.
std::vector<std::string> option_words(const std::string& option, const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? std::vector<std::string>{option} : std::vector<std::string>{};
  std::vector<std::string> words;
  const auto add = [&](const std::string& text) { words.insert(words.end(), {option, text}); };
  if (value.is_object()) {
    for (const auto& [path, values] : value.items())
      add(path + "=" + (option == "--set" ? text_of(values) : values_text(values)));
  } else if (value.is_array() && option == "--between" && value.size() == 2) {
    add(text_of(value[0]) + ":" + text_of(value[1]));
  } else if (value.is_array() && option == "--bound") {
    for (const Json& bound : value) add(text_of(bound));
  } else {
    add(values_text(value));
  }
  return words;
}

/// A scenario's file is looked for next to the study's first, and then as other words of a command are.
std::string scenario_beside(const fs::path& study, const std::string& name) {
  const fs::path file = study.parent_path() / name;
  std::error_code error;
  return name.ends_with(".json") && fs::exists(file, error) ? file.lexically_normal().string() : name;
}

std::size_t line_of(const std::string& text, const std::string& key) {
  const std::size_t at = text.find("\"" + key + "\"");
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

Json study_json(const fs::path& file, const std::string& text) {
  try {
    Json study = parse_json(text);
    if (study.is_object() && study.contains(kAsk) && study[kAsk].is_string() && study.contains("scenarios") &&
        study["scenarios"].is_array())
      return study;
  } catch (const InputError& error) {
    fail_in_file(file, error.what());
  }
  fail_in_file(
      file,
      R"(is not a study; allowed: {"ask": COMMAND, "scenarios": [...], and the command's options by their names})");
}

}  // namespace

std::vector<BundledStudy> bundled_studies() {
  std::vector<BundledStudy> found;
  for (const auto& entry : fs::directory_iterator(studies_folder())) {
    if (entry.path().extension() != ".json") continue;
    const Json study = study_json(entry.path(), read_text_file(entry.path(), kLargestJsonFile));
    found.push_back({entry.path().stem().string(), study[kAsk], study.value("summary", ""), entry.path()});
  }
  std::ranges::sort(found, {}, &BundledStudy::name);
  return found;
}

std::optional<StudyWords> StudyWords::in(const std::vector<std::string>& words) {
  if (words.size() < 2 || words[0].starts_with("-") || words[0] == "describe") return std::nullopt;
  for (std::size_t place = 1; place < words.size(); ++place) {
    // The value of an option is none: a file of a device has no "ask".
    if (words[place].starts_with("-")) continue;
    const std::optional<StudyFile> named = find_study(words[place]);
    if (!named) continue;
    const auto& [file, text] = *named;
    const Json study = study_json(file, text);
    if (study[kAsk] != words[0]) {
      fail_in_line(file, line_of(text, kAsk),
                   fmt::format("is a question for \"hapbench {} {}\"", study[kAsk].get<std::string>(), words[place]));
    }
    StudyWords found{file, words, {}};
    found.words.erase(found.words.begin() + static_cast<std::ptrdiff_t>(place));
    std::vector<std::string> asked;
    for (const Json& scenario : study["scenarios"]) asked.push_back(scenario_beside(file, text_of(scenario)));
    for (const auto& [key, value] : study.items()) {
      const std::string option = "--" + key;
      const auto is_given = [&option](const std::string& word) {
        return word == option || word.starts_with(option + "=");
      };
      if (std::ranges::find(kNoOptions, key) != std::end(kNoOptions)) continue;
      // What may be given several times adds up.
      if (!value.is_object() && std::any_of(words.begin(), words.end(), is_given)) continue;
      found.lines[option] = line_of(text, key);
      std::ranges::move(option_words(option, value), std::back_inserter(asked));
    }
    found.words.insert(found.words.begin() + 1, asked.begin(), asked.end());
    return found;
  }
  return std::nullopt;
}

InputError StudyWords::located(const InputError& error) const {
  const std::string text = error.what();
  for (const auto& [option, line] : lines) {
    const std::size_t at = text.find(option);
    if (at == std::string::npos || text.substr(at + option.size(), 1).find_first_of("abcdefghijklmnopqrstuvwxyz-") == 0)
      continue;
    return InputError(fmt::format("{}:{}: {}", file.string(), line, text));
  }
  return error;
}

}  // namespace hapbench
