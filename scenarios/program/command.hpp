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

/// A thin wrapper of CLI11, so that few sources compile the large header of CLI11.
namespace hapbench {

/// Rules for the values of an option or argument. The type of the bound variable sets the type of the value.
struct ValueRules {
  bool required = false;
  bool several = false;  ///< true if the option may be given several times, each time with one value
  /// True if the value is a list separated by commas. Spaces around the entries of the list are removed.
  bool comma_separated = false;
  std::optional<std::pair<std::int64_t, std::int64_t>> range = {};  ///< smallest and largest allowed number
  std::vector<std::string> one_of = {};                             ///< allowed values; empty: every value
};

/// A subcommand to which options are added. Precondition: the bound variables live until the command line has
/// been parsed, because parsing writes them.
class Command {
 public:
  template <class... Values>
  using OneOf = std::variant<std::reference_wrapper<Values>...>;
  using Variable = OneOf<std::string, std::vector<std::string>, int, unsigned, std::int64_t, std::uint64_t, double>;

  explicit Command(CLI::App* app) : app_(app) {}

  /// Adds an option if the name begins with "--", otherwise a positional argument. `name` may end with a space and the
  /// placeholder that the help shows for the value, as in "--out <dir>" or "scenarios <scenario>...".
  void add(const std::string& name, Variable variable, const std::string& help, const ValueRules& rules = {});
  void flag(const std::string& name, bool& value, const std::string& help);
  /// Makes parsing fail if `option` is given without `other`. An option can require one other option at most.
  /// Precondition: both options were added.
  void needs(const std::string& option, const std::string& other);
  /// Sets the text that the help prints between the options and the examples. Each line of the text is a paragraph,
  /// which is wrapped.
  void footer(const std::string& text);

 private:
  CLI::App* app_;
};

}  // namespace hapbench
