#include "scenarios/program/python_command.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

/// The reason why a package ended without a reply, such as a missing package: the last line of its output.
std::string last_line(std::string_view text) {
  constexpr std::string_view kPrefix = "hapbench: error: ";
  while (text.ends_with('\n')) text.remove_suffix(1);
  text.remove_prefix(text.rfind('\n') + 1);
  if (text.starts_with(kPrefix)) text.remove_prefix(kPrefix.size());
  return one_line(std::string(text));
}

}  // namespace

CommandOption PythonOptions::list(Command& command, const std::string& name, const std::string& help) {
  return command.add("--" + name, lists[name], help).comma_separated();
}

CommandOption PythonOptions::word(Command& command, const std::string& name, const std::string& help) {
  return command.add("--" + name, words[name], help);
}

CommandOption PythonOptions::number(Command& command, const std::string& name, const std::string& help,
                                    double otherwise) {
  return command.add("--" + name, numbers[name] = otherwise, help);
}

CommandOption PythonOptions::flag(Command& command, const std::string& name, const std::string& help) {
  return command.flag("--" + name, flags[name], help);
}

std::optional<Json> PythonOptions::reply(const char* package, const char* doing, const std::filesystem::path& out,
                                         const std::vector<std::string>& more) const {
  std::vector<std::string> line = {(installed_folder("scripts/python") / "launch").string(), package,
                                   fmt::format("out={}", out.string())};
  const auto add = [&line](std::string_view name, const auto& value) {
    line.push_back(fmt::format("{}={}", name, value));
  };
  for (const std::string& word : more)
    if (!word.empty()) line.push_back(word);
  for (const auto& [name, word] : words)
    if (!word.empty()) add(name, word);
  for (const auto& [name, list] : lists)
    for (const std::string& word : list) add(name, word);
  for (const auto& [name, number] : numbers)
    if (number >= 0.0) add(name, number);
  for (const auto& [name, is_given] : flags)
    if (is_given) add(name, true);
  const ProgramOutput tool = [&] {
    const WaitNotice notice(doing, !output.quiet);
    return output_of(line);
  }();
  throw_if_stopped();
  if (tool.status != 0) {
    print_error(last_line(tool.text));
    return std::nullopt;
  }
  // The last line of the output: a shell may have warned of the locale before.
  Json answer = parse_json(tool.text.substr(tool.text.rfind('\n') + 1));
  if (answer.contains("io_error"))
    throw IoError("write", out, std::error_code(answer["io_error"].get<int>(), std::generic_category()));
  std::vector<InputError> faults;
  for (const Json& fault : answer.value("faults", Json::array()))
    faults.emplace_back(InputError::Kind::relation, fault[0].get<std::string>(), fault[1].get<std::string>());
  if (!faults.empty()) throw InputError::all(faults);
  return answer;
}

void PythonOptions::print_made(Json& json, const std::filesystem::path& out, const Table& table,
                               const std::string& next) const {
  print_warnings(json["warnings"].get<std::vector<std::string>>());
  json["next"] = next;
  print(output, fmt::format("{}\n{}\nnext: {}\n", out.string(), table.text(), next), json);
}

}  // namespace hapbench
