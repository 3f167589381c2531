#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace hapbench {

/// Returns `text` with each control character replaced by '?'. File names and values from users may contain such
/// characters.
std::string one_line(std::string text);

/// Maximum number of errors reported per file.
inline constexpr std::size_t kMaxFaults = 20;

/// Location of a fault. Members that do not apply are empty or 0.
struct ErrorLocation {
  std::string option = {};  ///< faulty command-line option as typed, such as "--set time.step_s=0"
  std::vector<std::filesystem::path> outer =
      {};  ///< files that lead to `file`, such as a scenario that names a mesh; the outermost file first
  std::filesystem::path file = {};
  std::size_t line = 0;      ///< line in `file`, from 1; 0: not known
  std::string entry = {};    ///< entry of `file`, such as "sample 3"
  std::string pointer = {};  ///< JSON pointer of the field
  /// Names of the options that the problem is about, such as "--between"; the option at fault comes first. text() omits
  /// these names, because the text of the problem contains them. A study uses the names to find the line of its file
  /// that gives the option.
  std::vector<std::string> about_options = {};

  /// Returns the location in the form in which a message begins with it, such as "scene.json: /time/step_s" or
  /// "mesh.obj, line 3".
  std::string text() const;
};

/// Thrown for invalid input: a file, an argument or a field that the program rejects. The program then exits with
/// status 2. The message is one line with the location, the given value, the allowed values and, for names, the
/// nearest valid name. An error may hold several faults; the message describes the first fault.
class InputError : public std::runtime_error {
 public:
  enum class Kind {
    shape,     ///< a single field is wrong; the JSON Schema rejects it too
    relation,  ///< fields contradict each other, or a file is missing; a schema cannot express such a rule
  };

  InputError(Kind kind, ErrorLocation location, const std::string& problem);
  /// An error in the field at a JSON pointer. An empty pointer stands for the whole file.
  InputError(Kind kind, const std::string& pointer, const std::string& problem);
  /// An error of kind `relation` that is not about a particular field.
  explicit InputError(const std::string& problem);
  /// Combines the faults of several errors into one error. Faults of kind `shape` come first; faults beyond
  /// kMaxFaults are dropped. Precondition: `errors` is not empty.
  static InputError all(const std::vector<InputError>& errors);

  Kind kind() const { return kind_; }
  const ErrorLocation& location() const { return location_; }
  /// Returns the location as text; empty if the location has no parts.
  const std::string& location_text() const { return location_text_; }
  const std::string& problem() const { return problem_; }
  /// Returns each fault as an error. An error that was not made by `all` has one fault.
  std::vector<InputError> faults() const;

 private:
  InputError(Kind kind, ErrorLocation location, std::string location_text, std::string problem);

  Kind kind_;
  ErrorLocation location_;
  std::string location_text_;
  std::string problem_;
  std::vector<InputError> more_;  ///< all faults except the first
};

// Each of these functions throws an InputError of kind `relation`.
/// Throws an InputError about the field at a JSON pointer.
[[noreturn]] void fail_at(const std::string& pointer, const std::string& problem);
/// Throws an InputError about a file.
[[noreturn]] void fail_in_file(const std::filesystem::path& file, const std::string& problem);
/// Throws an InputError about a line of a file. Lines count from 1.
[[noreturn]] void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem);
/// Throws an InputError about the given location.
[[noreturn]] void fail_in(ErrorLocation location, const std::string& problem);
/// Throws an InputError about the value of an option, whose name begins the message: "--between: got …".
[[noreturn]] void fail_in_option(const std::string& option, const std::string& problem);

}  // namespace hapbench
