#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

/// A thin front of CLI11, so that few sources compile that header.
namespace hapbench {

/// How an option or an argument may be given; its variable says of what kind the value is.
struct Takes {
  bool required = false;
  bool several = false;          ///< it may be given several times, each time with one value
  bool comma_separated = false;  ///< several values in one word; white space around them does not count
  std::optional<std::pair<std::int64_t, std::int64_t>> range = {};  ///< refuses numbers outside
  std::vector<std::string> one_of = {};                             ///< refuses other words
};

/// A subcommand that takes its options. The variables bound here are written, and must live, until the line is parsed.
class Command {
 public:
  template <class... Values>
  using OneOf = std::variant<std::reference_wrapper<Values>...>;
  using Variable = OneOf<std::string, std::vector<std::string>, int, unsigned, std::int64_t, std::uint64_t, double>;

  explicit Command(CLI::App* app) : app_(app) {}

  /// A name that begins with "--" is an option, another one a positional argument. The name may be followed by a blank
  /// and the placeholder of its value in the help, such as "--out <dir>" or "scenarios <scenario>...".
  void add(const std::string& name, Variable variable, const std::string& help, const Takes& takes = {});
  void flag(const std::string& name, bool& value, const std::string& help);
  /// Refuses an option without another one, of which it has one at most. Precondition: both were added.
  void needs(const std::string& option, const std::string& other);
  /// Text between the options and the examples. Each line is a paragraph, which is wrapped.
  void footer(const std::string& text);

 private:
  CLI::App* app_;
};

}  // namespace hapbench
