#include "scenarios/program/command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

void Command::add(const std::string& name, Variable variable, const std::string& help, const ValueRules& rules) {
  const std::size_t blank = std::min(name.find(' '), name.size());
  const std::string bare = name.substr(0, blank);
  CLI::Option* option = std::visit([&](auto value) { return app_->add_option(bare, value.get(), help); }, variable);
  if (blank < name.size()) option->type_name(name.substr(blank + 1));
  option->required(rules.required);
  if (rules.several) option->allow_extra_args(false)->take_all();
  if (rules.comma_separated)
    option->delimiter(',')->transform([](const std::string& value) { return CLI::detail::trim_copy(value); });
  // Do not use the checks of CLI11: they word their errors differently and add text to the help.
  const auto problem = [range = rules.range, values = rules.one_of](const std::string& value) -> std::string {
    std::int64_t number = 0;
    if (range && !(CLI::detail::lexical_cast(value, number) && number >= range->first && number <= range->second))
      return fmt::format("got {}; allowed: {} ... {}", value, range->first, range->second);
    if (values.empty() || std::ranges::find(values, value) != values.end()) return "";
    return fmt::format("got \"{}\"{}; allowed: {}", value, nearest_name_hint(value, values), quoted_list(values));
  };
  option->check(CLI::Validator(problem, ""));
}

void Command::flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

void Command::needs(const std::string& option, const std::string& other) {
  app_->get_option(option)->needs(app_->get_option(other));
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

}  // namespace hapbench
