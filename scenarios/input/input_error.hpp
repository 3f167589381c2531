#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace hapbench {

/// `text` with a '?' in place of each control character (file names and values from outside may have some).
std::string one_line(std::string text);

/// Maximum number of errors reported per file.
inline constexpr std::size_t kMostFaults = 20;

/// The place of a fault, as data. What does not apply is empty.
struct ErrorLocation {
  std::string option = {};                        ///< option with the fault, as typed: "--set time.step_s=0"
  std::vector<std::filesystem::path> outer = {};  ///< files by which `file` was found, the outermost first
  std::filesystem::path file = {};
  std::size_t line = 0;      ///< in the file, from 1; 0: none
  std::string entry = {};    ///< of the file, as "sample 3"
  std::string pointer = {};  ///< JSON pointer of the field
  /// Names of the options that the problem is about, the option at fault first: "--between". They are no part of the
  /// text, which the problem words; a study finds the line by them that gave an option.
  std::vector<std::string> about_options = {};

  /// The parts that are there, as a message begins with them: "scene.json: /time/step_s" or "mesh.obj, line 3".
  std::string text() const;
};

/// Bad input: a file, an argument or a field the program refuses. Exit status 2. The message is one line that names the
/// place, the value given, what is allowed and, for names, the nearest valid one: the first of perhaps several faults.
class InputError : public std::runtime_error {
 public:
  enum class Kind {
    shape,     ///< one field by itself is wrong; the JSON Schema refuses it too
    relation,  ///< fields contradict each other or the world (a missing file); a schema cannot express that
  };

  InputError(Kind kind, ErrorLocation location, const std::string& problem);
  /// An error in the field at a JSON pointer; an empty pointer means the whole file.
  InputError(Kind kind, const std::string& pointer, const std::string& problem);
  /// An error of kind `relation` that is not about a particular field.
  explicit InputError(const std::string& problem);
  /// Several faults, at most kMostFaults of them, those of kind `shape` first. Precondition: there is at least one.
  static InputError all(const std::vector<InputError>& errors);

  Kind kind() const { return kind_; }
  const ErrorLocation& location() const { return location_; }
  /// The text of the location; empty for the whole file.
  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  /// The faults one by one; only one unless the error was made by `all`.
  std::vector<InputError> faults() const;

 private:
  InputError(Kind kind, ErrorLocation location, std::string place, std::string problem);

  Kind kind_;
  ErrorLocation location_;
  std::string place_;
  std::string problem_;
  std::vector<InputError> more_;  ///< all faults but the first
};

/// Throws an InputError (a relation) about the field at a JSON pointer, about a file, a line of it, or another place.
[[noreturn]] void fail_at(const std::string& pointer, const std::string& problem);
[[noreturn]] void fail_in_file(const std::filesystem::path& file, const std::string& problem);
[[noreturn]] void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem);
[[noreturn]] void fail_in(ErrorLocation location, const std::string& problem);
/// Throws an InputError about the value of an option, whose name begins the message: "--between: got …".
[[noreturn]] void fail_in_option(const std::string& option, const std::string& problem);

}  // namespace hapbench
