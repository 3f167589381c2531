#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hapbench {

/// `text` with a '?' in place of each control character (file names and values from outside may have some).
std::string one_line(std::string text);

/// Maximum number of errors reported per file.
inline constexpr std::size_t kMostFaults = 20;

/// Bad input: a file, an argument or a field the program refuses. Exit status 2. The message is one line that names the
/// place, the value given, what is allowed and, for names, the nearest valid one: the first of perhaps several faults.
class InputError : public std::runtime_error {
 public:
  enum class Kind {
    shape,     ///< one field by itself is wrong; the JSON Schema refuses it too
    relation,  ///< fields contradict each other or the world (a missing file); a schema cannot express that
  };

  InputError(Kind kind, std::string place, const std::string& problem)
      : std::runtime_error(one_line(place.empty() ? problem : place + ": " + problem)),
        kind_(kind),
        place_(std::move(place)),
        problem_(problem) {}
  /// An error of kind `relation` that is not about a particular field.
  explicit InputError(const std::string& problem) : InputError(Kind::relation, "", problem) {}
  /// Several faults, at most kMostFaults of them, those of kind `shape` first. Precondition: there is at least one.
  static InputError all(const std::vector<InputError>& errors);

  Kind kind() const { return kind_; }
  /// JSON pointer of the field; empty for the whole file.
  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  /// The faults one by one; only one unless the error was made by `all`.
  std::vector<InputError> faults() const;

 private:
  Kind kind_;
  std::string place_;
  std::string problem_;
  std::vector<InputError> more_;  ///< all faults but the first
};

/// Throws an InputError (a relation) about a place, about a file, or about a line of it.
[[noreturn]] void fail_at(const std::string& place, const std::string& problem);
[[noreturn]] void fail_in_file(const std::filesystem::path& file, const std::string& problem);
[[noreturn]] void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem);

}  // namespace hapbench
