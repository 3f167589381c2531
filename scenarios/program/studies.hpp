#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/program_arguments.hpp"

/// Studies: command lines stored as JSON files. A study names a command, scenarios and the command's options.
/// The user gives the study to the command instead of scenarios.
///
///   {"ask": "limit", "scenarios": ["wall_on_handle"], "summary": "K over B of a wall on an impedance device",
///    "between": [1e2, 1e5], "stable": "bounded",
///    "over": {"rendering.damping_N_s_per_m": {"from": 0.1, "to": 150, "count": 17, "log": true}}}
///
/// A number or a text is the value of its option. True gives an option that has no value, and false omits the option.
/// A list of two numbers for "between" is a range. Other lists are values separated by commas; each entry of "bound"
/// becomes a separate option. The objects "set", "over" and "vary" map paths of fields to a value, a list, or a range
/// with "from", "to", "count" and "log". A scenario file is searched next to the study first. "alone": true
/// marks a study that measures times: scripts/reproduce runs nothing else at the same time as this study.
namespace hapbench {

/// A study in the folder scenarios/library/studies; `ask` is the command.
struct BundledStudy {
  std::string name, ask, summary;
  std::filesystem::path file;
};
/// Returns the bundled studies, sorted by name.
std::vector<BundledStudy> bundled_studies();

/// The arguments of a command line after a study was replaced by its content, and the lines of the study's file
/// that they come from.
struct StudyArguments {
  /// Replaces the first study on a command line by its scenarios and options. An option of the command line takes
  /// precedence over the same option of the study. If the study's value is an object, the options of the study and of
  /// the command line are both used.
  /// `arguments`: the command line without the program's name. `positions`: indices of the positional arguments, which
  /// may name a study. Returns empty if no argument names a study. Throws InputError for a study of another command.
  static std::optional<StudyArguments> in(const ProgramArguments& arguments, std::span<const std::size_t> positions);

  /// Returns the error with the study's file and line in front. The line is the line of the first option in
  /// ErrorLocation::about_options that the study gives. Returns the error unchanged if the study has none of these
  /// options.
  InputError located(const InputError& error) const;

  std::filesystem::path file;
  ProgramArguments arguments;
  std::map<std::string, std::size_t> lines;  ///< line of each option in `file`; the keys are like "--over"
};

}  // namespace hapbench
