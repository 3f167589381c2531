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
};

/// robustness.json: the counts of every claim, and the hash of the choices they are about.
Json robustness_json(const RobustnessPlan& plan, const std::vector<ClaimRobustness>& claims);
/// The same as a Markdown table.
std::string robustness_markdown(const RobustnessPlan& plan, const std::vector<ClaimRobustness>& claims);

/// The record of robustness.json about claims, by id.
class RobustnessOnRecord {
 public:
  /// An empty record.
  RobustnessOnRecord() = default;
  /// Takes the record if it is about the choices with this hash; a record of other choices counts as empty. Throws
  /// InputError when it is no such record.
  RobustnessOnRecord(const Json& record, const std::string& choices_hash);
  /// The same from a file; empty when there is none.
  RobustnessOnRecord(const std::filesystem::path& file, const std::string& choices_hash);

  /// The claim's counts if the recorded verdict is this one; else null.
  Json of(const JudgedClaim& judged) const;

 private:
  std::map<std::string, Json> claims_;
};

/// The counts in words: "this verdict in 91 of 100 samples; decided by task2.hand_angle (S = 0.43)"; empty for null.
std::string robustness_text(const Json& robustness);

/// claims.json
Json ledger_json(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                 const RobustnessOnRecord& robustness);
/// claims.md
std::string ledger_markdown(const std::vector<JudgedClaim>& judged, const PublishedNumbers& published,
                            const RobustnessOnRecord& robustness);

}  // namespace hapbench
