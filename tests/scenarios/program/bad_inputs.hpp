#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

/// Inputs the program must refuse, and what the line of its message must hold.
namespace hapbench::test {

struct BadInput {
  std::string name;                               ///< of the test
  std::string scenario;                           ///< text of the scenario file
  std::string place;                              ///< in the message behind the file's name: a JSON pointer, mostly
  std::string says;                               ///< in the message behind the place
  std::map<std::string, std::string> files = {};  ///< others beside the scenario
  std::string (*make)() = nullptr;                ///< makes the scenario's text when it is too large to keep
  std::size_t faults = 1;                         ///< lines of message; the first is the one meant
};

/// So that test listings show the name.
void PrintTo(const BadInput& input, std::ostream* out);  // NOLINT: GoogleTest's name

/// The minimal scenario of an environment type with `value`, JSON or not, at the pointer.
std::string with_value(const std::string& environment, const std::string& pointer, const std::string& value);
/// The minimal scenario of an environment changed by a JSON merge patch (RFC 7386).
std::string with_patch(const std::string& environment, const std::string& patch);

std::vector<BadInput> malformed_texts();
std::vector<BadInput> wrong_values();
std::vector<BadInput> wrong_structures();
std::vector<BadInput> contradictions();
std::vector<BadInput> absurd_sizes();
std::vector<BadInput> bad_shell_files();
std::vector<BadInput> bad_mesh_files();
std::vector<BadInput> bad_motion_files();

}  // namespace hapbench::test
