#include "scenarios/program/studies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAsk = "ask";
/// Members of a study that are not options of its command.
constexpr const char* kDescriptiveMembers[] = {kAsk, "scenarios", "summary", "source", "alone", "$schema"};

fs::path studies_folder() {
  return installed_folder("scenarios/library") / "studies";
}

/// Returns the file and the text of the study that an argument names. Returns empty for other arguments and for
/// files that cannot be read.
std::optional<std::pair<fs::path, std::string>> find_study(const std::string& argument) {
  std::error_code error;
  try {
    const bool is_file = argument.ends_with(".json") && fs::is_regular_file(argument, error);
    if (!is_file && (argument.find('/') != std::string::npos || fs::exists(argument, error))) return std::nullopt;
    const fs::path file = is_file ? fs::path(argument) : studies_folder() / (argument + ".json");
    const std::string text = read_text_file(file, kMaxJsonFileBytes);
    if (text.find("\"ask\"") != std::string::npos) return std::pair(file, text);
  } catch (const InputError&) {  // no such file
  }
  return std::nullopt;
}

/// Returns a value of a study as it is written on a command line.
std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return cell_text(value.get<double>());
  return value.dump();
}

/// Returns values of a study as they are written on a command line: a single value, "a,b" or
/// "from:to:count:log".
std::string values_text(const Json& values) {
  if (values.is_object() && values.contains("from")) {
    const std::string count = values.contains("count") ? ":" + text_of(values["count"]) : "";
    return fmt::format("{}:{}{}{}", text_of(values.at("from")), text_of(values.value("to", Json())), count,
                       values.value("log", false) ? ":log" : "");
  }
  return values.is_array() ? fmt::format("{}", fmt::join(names_of(values, text_of), ",")) : text_of(values);
}

/// Returns the command-line arguments that set `option` to `value`. If `value` is an object, the arguments have the
/// option once for each member of the object.
ProgramArguments option_arguments(const std::string& option, const Json& value) {
  if (value.is_boolean()) return ProgramArguments(value.get<bool>() ? 1 : 0, option);
  ProgramArguments arguments;
  const auto add = [&](const std::string& text) { arguments.insert(arguments.end(), {option, text}); };
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
  return arguments;
}

/// If the folder of the study has a scenario file with this name, returns the path of the file. Otherwise returns the
/// name, which the command resolves like every scenario name.
std::string scenario_beside(const fs::path& study, const std::string& name) {
  const fs::path file = study.parent_path() / name;
  std::error_code error;
  return name.ends_with(".json") && fs::exists(file, error) ? file.lexically_normal().string() : name;
}

/// Returns the number of the line of a key in the text of a study. The first line has the number 1.
std::size_t line_of(const std::string& text, const std::string& key) {
  const std::size_t at = text.find("\"" + key + "\"");
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

/// Returns the content of a study. Throws InputError if it is no study.
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
    const Json study = study_json(entry.path(), read_text_file(entry.path(), kMaxJsonFileBytes));
    found.push_back(
        {entry.path().stem().string(), study.at(kAsk).get<std::string>(), study.value("summary", ""), entry.path()});
  }
  std::ranges::sort(found, {}, &BundledStudy::name);
  return found;
}

std::optional<StudyArguments> StudyArguments::in(const ProgramArguments& arguments,
                                                 std::span<const std::size_t> positions) {
  if (arguments.empty() || arguments[0] == "describe") return std::nullopt;
  // Find the first argument that names a study.
  std::optional<std::pair<fs::path, std::string>> found_study;
  std::size_t study_index = 0;
  for (std::size_t i = 0; i < positions.size() && !found_study; ++i) {
    study_index = positions[i];
    found_study = find_study(arguments[study_index]);
  }
  if (!found_study) return std::nullopt;
  const auto& [file, text] = *found_study;
  const Json study = study_json(file, text);
  if (study[kAsk] != arguments[0])
    fail_in_line(
        file, line_of(text, kAsk),
        fmt::format("is a question for \"hapbench {} {}\"", study[kAsk].get<std::string>(), arguments[study_index]));
  // Put the scenarios first, then the options of the study, then the other arguments of the command line.
  StudyArguments found{file, {arguments[0]}, {}};
  for (const Json& scenario : study["scenarios"]) found.arguments.push_back(scenario_beside(file, text_of(scenario)));
  for (const auto& [key, value] : study.items()) {
    if (std::ranges::find(kDescriptiveMembers, key) != std::end(kDescriptiveMembers)) continue;
    const std::string option = "--" + key;
    if (key == "module" || key == "allow-modules")
      fail_in_line(file, line_of(text, key),
                   fmt::format("{}: cannot be in a study, because it causes code to be executed; allowed: {} on the "
                               "command line",
                               key, option));
    const auto is_given = [&](const std::string& argument) {
      return argument == option || argument.starts_with(option + "=");
    };
    // An option of the command line replaces the same option of the study. If the study's value is an object, the
    // option may be repeated, and both options are used.
    if (!value.is_object() && std::ranges::any_of(arguments, is_given)) continue;
    found.lines[option] = line_of(text, key);
    std::ranges::move(option_arguments(option, value), std::back_inserter(found.arguments));
  }
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (i != study_index) found.arguments.push_back(arguments[i]);
  return found;
}

InputError StudyArguments::located(const InputError& error) const {
  for (const std::string& option : error.location().about_options) {
    const auto line = lines.find(option);
    if (line == lines.end()) continue;
    return InputError(fmt::format("{}:{}: {}", file.string(), line->second, error.what()));
  }
  return error;
}

}  // namespace hapbench
