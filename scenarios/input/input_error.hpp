#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// `text` with a '?' in place of each control character (file names and values from outside may have some).
std::string one_line(std::string text);

/// Faults of one file that are reported at once; more nobody mends before trying again.
inline constexpr std::size_t kMostFaults = 20;

/// Bad input: a file, an argument or a field the program refuses. Exit status 2. The message is one line that names the
/// place, the value given, what is allowed and, for names, the nearest valid one. It may stand for several faults, of
/// which the message is the first.
class InputError : public std::runtime_error {
 public:
  enum class Kind {
    shape,     ///< one field by itself is wrong; the JSON Schema refuses it too
    relation,  ///< fields contradict each other, or the world (a missing file); beyond what a schema can say
  };

  InputError(Kind kind, std::string place, const std::string& problem)
      : std::runtime_error(one_line(place.empty() ? problem : place + ": " + problem)),
        kind_(kind),
        place_(std::move(place)),
        problem_(problem) {}
  /// A relation without a field of its own.
  explicit InputError(const std::string& problem) : InputError(Kind::relation, "", problem) {}
  /// Several faults, at most kMostFaults of them, those of a shape first. Precondition: there is one.
  static InputError all(const std::vector<InputError>& errors);

  Kind kind() const { return kind_; }
  /// JSON pointer of the field; empty for the whole file.
  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  /// Each by itself; one, unless it was made by `all`.
  std::vector<InputError> faults() const;

 private:
  Kind kind_;
  std::string place_;
  std::string problem_;
  std::vector<InputError> more_;  ///< behind the first
};

/// Throws an InputError (a relation) about a file, or about a line of it.
[[noreturn]] void fail_in_file(const std::filesystem::path& file, const std::string& problem);
[[noreturn]] void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem);

/// The valid name nearest to `given` in edit distance, or empty when none is near enough to suggest. A name may also be
/// given without its unit or any other end behind an underscore, and its case does not matter.
std::string nearest_name(std::string_view given, std::span<const std::string> valid);

/// `; nearest valid name: "x"`, or empty.
std::string nearest_name_hint(std::string_view given, std::span<const std::string> valid);

/// Throws an InputError, `got` before the name, when the name is not among the valid ones.
void require_valid_name(std::string_view got, const std::string& name, std::span<const std::string> valid);

/// "a", "b", "c"; of very many names the first ones and how many more there are.
std::string quoted_list(std::span<const std::string> names);

}  // namespace hapbench
