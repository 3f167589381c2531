#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/analysis/tuning/tune.hpp"
#include "scenarios/program/options.hpp"

/// Turns the options of `tune` into a question.
namespace hapbench {

/// The options of `tune`.
struct TuneOptions : CommonOptions {
  std::string scenario, device, damping_ratio, mass;
  std::string scale = "1";  ///< scale of the mount in the user's loop: virtual metres per metre of the device
  std::vector<std::string> algorithms, bounds, family;
  /// Question with the members that options set directly. tune_question() sets its other members.
  TuneQuestion question;
};

/// Returns the question for the scene in a file. Throws InputError.
TuneQuestion tune_question(const TuneOptions& options, const std::filesystem::path& file);
/// Adds the overrides of the named device to the question and returns " on NAME". Returns an empty text and
/// keeps the question if the name is empty. Throws InputError.
std::string device_text(const std::string& name, TuneQuestion& question);

}  // namespace hapbench
