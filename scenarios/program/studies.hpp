#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/program_words.hpp"

/// Studies: questions as files. A study names a command, scenarios, and the command's options, and a command takes
/// it in place of scenarios.
///
///   {"ask": "limit", "scenarios": ["wall_on_handle"], "summary": "K over B of a wall on an impedance device",
///    "between": [1e2, 1e5], "stable": "bounded",
///    "over": {"rendering.damping_N_s_per_m": {"from": 0.1, "to": 150, "count": 17, "log": true}}}
///
/// Numbers, texts and true stand for themselves; two numbers of "between" for a range; a list for values separated by
/// commas ("bound": for one option each); objects of "set", "over" and "vary" for fields by their paths, with a value,
/// a list or a range with "from", "to", "count" and "log". A scenario that is a file is looked for next to the study
/// first. "alone" is for scripts/reproduce: nothing runs at the same time as what is about time.
namespace hapbench {

struct BundledStudy {
  std::string name, ask, summary;
  std::filesystem::path file;
};
/// All of them, by name.
std::vector<BundledStudy> bundled_studies();

/// The words of a command line in which a study stood, and where in its file they come from.
struct StudyWords {
  /// Replaces the first study behind the command by its scenarios and options; options that are given besides go before
  /// those of the study. `words`: without the program's name. `arguments`: the places of the words that may name a
  /// study, which are neither options nor values of options. Throws InputError for a study of another command.
  static std::optional<StudyWords> in(const ProgramWords& words, std::span<const std::size_t> arguments);

  /// Returns the error with the line of the study in front that has the first of ErrorLocation::about_options; the
  /// error itself if the study has none of them.
  InputError located(const InputError& error) const;

  std::filesystem::path file;
  ProgramWords words;
  std::map<std::string, std::size_t> lines;  ///< of options, as "--over"
};

}  // namespace hapbench
