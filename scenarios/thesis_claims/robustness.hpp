#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/choices.hpp"
#include "scenarios/thesis_claims/claims.hpp"

/// How far the verdicts hang on the choices on record: the claims judged again at a Latin hypercube of the choices'
/// ranges. The point on record is not among them; the ledger is that.
namespace hapbench {

/// What claims read of each scenario's results: files, and sections of summary.json.
using ResultsRead = std::map<std::string, std::set<std::string>>;

/// Everything that the verdicts of a sample are a function of, and the program.
struct RobustnessPlan {
  Choices choices;
  PublishedNumbers published;
  std::vector<Claim> claims;
  ResultsRead read;  ///< by them; what else a scenario records is left out until a claim asks for it all the same
  std::vector<std::vector<std::string>> values;  ///< for each sample one of each choice

  std::size_t samples() const { return values.size(); }
  /// Costly claims are judged in the first of the samples only.
  std::size_t costly_samples() const { return samples() / 4; }
};

inline constexpr std::uint64_t kRobustnessSeed = 1;

/// The plan for so many samples. Of the claims those about time are left out.
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

}  // namespace hapbench
