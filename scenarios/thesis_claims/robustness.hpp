#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "results/summary/provenance.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/thesis_claims/choices.hpp"
#include "scenarios/thesis_claims/claims.hpp"

/// Robustness of the verdicts: the claims judged again at a Latin hypercube of the ranges of the choices on record, and
/// the choices that decide. The values on record are not among the samples; they are the ledger's.
namespace hapbench {

// Statistics of a sample: which input decides a yes or no.

/// For each value the number of its bin, when the values in order are cut into `bins` of equal count; of equal values
/// the first ones come first.
std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins);

/// The first-order Sobol index of an input, Var(E[y | x]) / Var(y), from given data: x is cut into bins (one for each
/// value of a discrete input) and E[y | x] is the mean of y in a bin,
///
///   S = (SSB - (B - 1) SSW / (n - B)) / SST,  SSB = sum_b n_b (mean_b - mean)^2,  SSW = SST - SSB,
///
/// for n points in B bins that are not empty. Without the subtracted term, the mean of SSB when x has no influence,
/// this is the estimator of Plischke, Borgonovo, Smith, "Global sensitivity measures from given
/// data", EJOR 226 (2013) 536-550; with it, Kelley's epsilon squared (1935). May be a little below 0. NaN when y never
/// changes or there are no more points than bins. Precondition: as many bins as values.
double first_order_index(std::span<const std::size_t> bin, std::span<const double> y);

/// The input with the largest index, if that is significant.
struct DecidingInput {
  std::size_t input = 0;
  double index = 0.0;
};

/// The input with the largest first-order index, if less than `level` of `permutations` random orders of y (seeded)
/// have a largest index as large: the largest of all inputs, so that many inputs do not make a false alarm likely. None
/// when y never changes.
std::optional<DecidingInput> deciding_input(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                            std::vector<double> y, std::uint64_t seed, double level = 0.01,
                                            std::size_t permutations = 999);

/// The parts of each scenario's results that claims read: files, and sections of summary.json.
using ResultsRead = std::map<std::string, std::set<std::string>>;

/// The inputs of the verdicts of a sample.
struct RobustnessPlan {
  Choices choices;
  PublishedNumbers published;
  std::vector<Claim> claims;
  ResultsRead read;  ///< by the claims; other records of a scenario are left out until a claim asks for them
  Cases cases;       ///< the samples: an axis for each choice
  std::vector<std::vector<std::string>> values;  ///< of the cases

  std::size_t samples() const { return values.size(); }
  /// Costly claims are judged in the first of the samples only.
  std::size_t costly_samples() const { return samples() / 4; }
};

inline constexpr std::uint64_t kRobustnessSeed = 1;

/// The plan for so many samples. Claims about times are left out. `published` without the choices' numbers.
RobustnessPlan plan_robustness(Choices choices, PublishedNumbers published, std::vector<Claim> claims, ResultsRead read,
                               std::size_t samples);

/// Cells of claims without a verdict: one that could not be measured (a run diverged where its scenario does not expect
/// it, a field refuses the value), and a costly one beyond the samples for those.
inline constexpr const char* kNotMeasured = "error";
inline constexpr const char* kNotJudged = "";

/// A sample's verdict on each claim, by name.
struct SampleVerdicts {
  std::vector<std::string> verdicts;
  std::vector<std::string> problems;  ///< of the claims that could not be measured, for people
};

/// Judges the claims under a sample's choices. Scenarios run when a claim asks, once, into `directory`, which is
/// removed afterwards. For several threads, with a directory each. Throws IoError.
SampleVerdicts judge_sample(const RobustnessPlan& plan, std::size_t sample, const std::filesystem::path& directory);

/// Robustness of one claim's verdict.
struct ClaimRobustness {
  std::string id;
  std::string on_record;       ///< the ledger's verdict
  std::size_t judged = 0;      ///< samples with a verdict
  std::size_t holds = 0;       ///< with the ledger's
  std::size_t reproduced = 0;  ///< with "reproduced"
  std::size_t not_measured = 0;
  std::map<std::string, std::size_t> verdicts;  ///< samples with each
  /// The choice that decides whether the ledger's verdict holds, and its first-order index (sensitivity.hpp); none when
  /// the verdict never changes or no choice stands out.
  struct DecidingChoice {
    std::string id;
    double index = 0.0;
  };
  std::optional<DecidingChoice> decided_by;
};

/// Counts and deciding choice of each claim. `on_record` are the ledger's verdicts, `verdicts` those of each sample.
std::vector<ClaimRobustness> robustness_of(const RobustnessPlan& plan, const std::vector<std::string>& on_record,
                                           const std::vector<std::vector<std::string>>& verdicts);

struct RobustnessOptions {
  std::filesystem::path directory;  ///< of the samples' table and of results while they are needed; exists
  std::size_t jobs = 1;             ///< samples at once
  bool anew = false;                ///< use nothing that an interrupted run has left
  bool progress = false;            ///< allow a progress bar
  std::string program = provenance().identity();  ///< whose samples are continued; empty: those of none
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
/// are in a table at once (table_file.hpp): after a kill the same plan, judged by the same program, goes on from there.
/// SIGINT and SIGTERM end it after the samples in flight. Throws IoError when something cannot be written.
RobustnessReport run_robustness(const RobustnessPlan& plan, const RobustnessOptions& options);

/// robustness.csv: sample, a column for each choice and one for each claim.
std::string robustness_table(const RobustnessPlan& plan, const std::vector<std::vector<std::string>>& verdicts);
/// A row of it, without its end.
std::string robustness_row(const RobustnessPlan& plan, std::size_t sample, const std::vector<std::string>& verdicts);

}  // namespace hapbench
