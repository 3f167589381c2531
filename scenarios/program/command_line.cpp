#include "scenarios/program/command_line.hpp"

#include <CLI/CLI.hpp>

#include "scenarios/program/command.hpp"

namespace hapbench {

CommandOption& CommandOption::required() {
  option_->required();
  return *this;
}

CommandOption& CommandOption::repeatable() {
  option_->allow_extra_args(false)->take_all();
  return *this;
}

CommandOption& CommandOption::comma_separated() {
  option_->delimiter(',')->transform([](const std::string& word) { return CLI::detail::trim_copy(word); });
  return *this;
}

CommandOption& CommandOption::range(int least, int greatest) {
  option_->check(CLI::Range(least, greatest));
  return *this;
}

CommandOption& CommandOption::range(std::uint64_t least, std::uint64_t greatest) {
  option_->check(CLI::Range(least, greatest));
  return *this;
}

CommandOption& CommandOption::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  return *this;
}

CommandOption& CommandOption::value_if_none(const std::string& value) {
  option_->expected(0, 1)->default_str(value);
  return *this;
}

CommandOption& CommandOption::needs(const CommandOption& other) {
  option_->needs(other.option_);
  return *this;
}

CommandOption& CommandOption::excludes(const CommandOption& other) {
  option_->excludes(other.option_);
  return *this;
}

CommandOption Command::add(const std::string& name, std::string& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::add(const std::string& name, std::vector<std::string>& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::add(const std::string& name, int& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::add(const std::string& name, std::int64_t& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::add(const std::string& name, unsigned& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::add(const std::string& name, double& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::add(const std::string& name, std::uint64_t& value, const std::string& help) {
  return CommandOption(app_->add_option(name, value, help));
}

CommandOption Command::flag(const std::string& name, bool& value, const std::string& help) {
  return CommandOption(app_->add_flag(name, value, help));
}

CommandOption Command::flag(const std::string& name, std::function<void()> when_given, const std::string& help) {
  return CommandOption(app_->add_flag_callback(name, std::move(when_given), help));
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

void Command::runs(Action action, std::string when_stopped) {
  ChosenCommand command{std::move(action), std::move(when_stopped)};
  app_->callback([&chosen = chosen_, command = std::move(command)] { chosen = command; });
}

CommandLine::CommandLine(const std::string& version)
    : app_(std::make_unique<CLI::App>("hapbench: an offline bench for haptic rendering", "hapbench")) {
  app_->set_version_flag("--version", version);
  app_->require_subcommand(1);
  app_->footer(
      "Exit status: 0 success, 1 internal fault, 2 bad input or usage, 3 a run did not end as its scenario expects, "
      "130 stopped by Ctrl-C.");
}

CommandLine::~CommandLine() = default;

Command CommandLine::command(const std::string& name, const std::string& summary) {
  return Command(app_->add_subcommand(name, summary), chosen_);
}

int CommandLine::run(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? kSuccess : kBadInput;
  }
  return chosen_.action();
}

}  // namespace hapbench
