#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/robustness.hpp"

/// The ledger's files: the verdict on each claim, and its robustness against the choices on record.
namespace hapbench {

/// A claim with the verdict on it.
struct JudgedClaim {
  Claim claim;
  Finding finding;
  std::vector<std::string> scenarios = {};  ///< bundled ones that it was measured with, in the order of their names
  std::string reach = {};                   ///< of the choices, as Choices::reach has it; empty: none reaches it

  /// Whether another reading of the choices could change the verdict: a simulation shows it, and a choice reaches it.
  bool can_be_sampled() const {
    return !claim.timing && finding.verdict != Verdict::not_reproducible && !reach.empty();
  }
};

/// robustness.json: the counts of every claim, and the hash of the choices they are about. `judged` as the plan's
/// claims. Of claims that are not among them, it keeps what such a record from before has.
Json robustness_json(const RobustnessPlan& plan, const std::vector<JudgedClaim>& judged,
                     const std::vector<ClaimRobustness>& claims, const Json& before = Json::object());
/// The same as a Markdown table.
std::string robustness_markdown(const Json& record);

/// The record of robustness.json about claims, by id.
class RobustnessOnRecord {
 public:
  /// An empty record.
  RobustnessOnRecord() = default;
  /// Throws InputError when it is no such record.
  explicit RobustnessOnRecord(const Json& record);
  /// The same from a file; empty when there is none.
  explicit RobustnessOnRecord(const std::filesystem::path& file);

  /// The claim's counts if the recorded verdict is this one and the choices that reach it are the same; else null.
  Json of(const JudgedClaim& judged) const;

 private:
  std::map<std::string, Json> claims_;
};

/// claims.json: the headline and the claims.
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                 const RobustnessOnRecord& robustness);

// The functions below take a claim as ledger_json writes it.

/// The recorded verdict, and in front of it that of most samples if it is another one.
std::string verdicts_text(const Json& claim);
/// Its entry "sureness", the counts in words: "this verdict in 91 of 100 samples; decided by task2.hand_angle (S =
/// 0.43)"; or why there are none.
std::string robustness_text(const Json& claim);
/// How many verdicts another reasonable reading would leave as they are, and which it would not.
std::string ledger_headline(const Json& claims);
/// claims.md: the headline, the claims of the thesis, and what was found on the way.
std::string ledger_markdown(const Json& ledger);

}  // namespace hapbench
