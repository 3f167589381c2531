#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/robustness.hpp"

namespace hapbench {

struct RobustnessOptions {
  std::filesystem::path directory;  ///< of the journal and of results while they are needed; exists
  std::size_t jobs = 1;             ///< samples at once
  bool anew = false;                ///< use nothing that an interrupted run has left
  bool progress = false;            ///< allow a progress bar
};

/// The verdicts of all samples.
struct RobustnessReport {
  std::vector<std::vector<std::string>> verdicts;  ///< by sample and claim; of a stopped run not to be used
  std::vector<std::string> problems;               ///< of this process's samples, in their order
  std::size_t done = 0;                            ///< samples
  std::size_t resumed = 0;                         ///< of them, by an earlier process
  int signal = 0;                                  ///< the signal that stopped it, or 0
};

/// Judges every sample of a plan, `jobs` at once. Verdicts depend neither on `jobs` nor on interruptions. Each sample's
/// are in a journal at once: after a kill the same plan, judged by the same program, goes on from there. SIGINT and
/// SIGTERM end it after the samples in flight. Throws InputError when another process is at work in the directory,
/// IoError when something cannot be written.
RobustnessReport run_robustness(const RobustnessPlan& plan, const RobustnessOptions& options);

/// robustness.csv: sample, a column for each choice and one for each claim.
std::string robustness_table(const RobustnessPlan& plan, const std::vector<std::vector<std::string>>& verdicts);
/// A row of it, without its end.
std::string robustness_row(const RobustnessPlan& plan, std::size_t sample, const std::vector<std::string>& verdicts);

}  // namespace hapbench
