#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/analysis/tuning/tune.hpp"
#include "scenarios/program/options.hpp"

/// The question of `tune`.
namespace hapbench {

/// The options of `tune`.
struct TuneOptions : CommonOptions {
  std::string scenario, device, damping_ratio, mass;
  std::vector<std::string> algorithms, bounds, family;
  TuneQuestion question;  ///< as far as options are its members
};

/// The question about the scene of a file. Throws InputError.
TuneQuestion tune_question(const TuneOptions& options, const std::filesystem::path& file);
/// Puts the device of that name into the question, none for an empty one. Returns " on NAME". Throws InputError.
std::string device_text(const std::string& name, TuneQuestion& question);

}  // namespace hapbench
