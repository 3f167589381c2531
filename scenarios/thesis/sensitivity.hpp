#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis/assumption_sets.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/judging.hpp"

/// Sensitivity of the verdicts, one assumption at a time: each claim is judged with each plausible value of each
/// assumption that can change it, while all other assumptions keep their recorded values and calibrated inputs are
/// calibrated again. The record is results/reference/sensitivity.json.
namespace hapbench {

/// Returns the text of the member `key`. Throws Json::exception if the member is missing or not a text.
inline std::string text_at(const Json& json, const char* key) {
  return json.at(key).get<std::string>();
}

/// The record of the verdicts, in memory and as a file.
///
/// For each claim the file has the hash of the assumptions that can change it (Assumptions::reach), the verdict and the
/// number under the recorded assumptions, and a list of cases: assumption, value, verdict and number. If the claim has
/// an earlier rule, the claim and each of its cases also have the verdict of this rule.
class SensitivityRecord {
 public:
  /// Creates an empty record.
  SensitivityRecord() = default;
  /// Reads the file; an empty record if there is no file. Throws InputError for another format.
  explicit SensitivityRecord(const std::filesystem::path& file);

  /// Returns the entry of a claim; null if the record has no entry of this claim with the hash `reach`
  /// (Assumptions::reach).
  Json entry(const std::string& claim, const std::string& reach) const;
  /// Begins the entry of a claim. `recorded` is the verdict under the recorded assumptions, and `complete` the number
  /// of cases of a complete entry. If the record has an entry of the claim with the same hash, verdicts and number, the
  /// new entry keeps the cases of the old entry. Otherwise the new entry has no cases.
  void begin(const std::string& claim, const std::string& reach, const SetFinding& recorded, std::size_t complete);
  /// Returns true if the entry of the claim has this case. Precondition: begin().
  bool has(const std::string& claim, const std::string& assumption, const std::string& value) const;
  /// Adds a case. Precondition: begin().
  void add(const std::string& claim, const std::string& assumption, const std::string& value, const SetFinding& found);
  /// Sorts the cases of each claim by assumption and value, in the order of `assumptions`. The record is then the same
  /// for any order in which the cases were judged.
  void sort_cases(const Assumptions& assumptions);
  /// Removes entries of claims that are not in the list.
  void keep_only(const std::vector<Claim>& claims);
  /// Returns the content of the file.
  std::string text() const;

 private:
  Json claims_ = Json::object();  ///< the entries, by the id of the claim
};

/// Returns true if the verdict of a case is a verdict on the claim: neither "not judged" nor "not measured".
bool was_judged(const std::string& verdict);

/// How a verdict depends on the assumptions.
struct Robustness {
  std::string word = {};  ///< kExactVerdict, kRobustVerdict, kSensitiveVerdict, kSeveralVerdict or kNotSampledVerdict
  std::vector<std::string> deciders = {};  ///< assumptions of which another plausible value changes the verdict
  /// Returns the word and the deciders, such as "exact", "sensitive to NAME" or "depends on several: NAME, NAME".
  std::string text() const;
};
inline constexpr const char* kExactVerdict = "exact";             ///< no assumption can change the claim
inline constexpr const char* kRobustVerdict = "robust";           ///< no single assumption changes the verdict
inline constexpr const char* kSensitiveVerdict = "sensitive to";  ///< one assumption changes the verdict
inline constexpr const char* kSeveralVerdict = "depends on several";
inline constexpr const char* kNotSampledVerdict = "not sampled";  ///< the record has no complete entry for the claim

/// Returns the robustness of a judged claim from its entry in the record; `entry` is null if the record has no entry.
/// A case without a verdict on the claim (not judged, not measured) is ignored. The robustness is kNotSampledVerdict in
/// each of these cases:
///   - The claim is about computing time or is not testable.
///   - Assumptions can change the claim, and the record has no entry.
///   - The entry lacks cases, and its cases show fewer than two assumptions that change the verdict.
Robustness robustness_of(const JudgedClaim& judged, const Json& entry);
/// Returns the robustness of the verdict of a claim's earlier rule, in the same way. Precondition: the claim has an
/// earlier rule.
Robustness earlier_robustness_of(const JudgedClaim& judged, const Json& entry);

/// Returns the number of cases in the complete entry of a claim. `scenarios`: names of the scenarios that the claim
/// uses.
std::size_t case_count(const Assumptions& assumptions, const Claim& claim, const std::vector<std::string>& scenarios);

/// A case of the record: the claims that one value of one assumption can change.
struct SensitivityCase {
  std::size_t assumption = 0;  ///< index in Assumptions::all()
  std::string value = {};
  std::vector<Claim> claims = {};
};

/// Returns the cases that the record lacks, first the cases of claims that are cheap to measure. Costly claims have no
/// case in the middle of a range. `reached[i]`: names of the scenarios that claims[i] uses.
std::vector<SensitivityCase> missing_cases(const SensitivityRecord& record, const Assumptions& assumptions,
                                           const std::vector<Claim>& claims,
                                           const std::vector<std::vector<std::string>>& reached);

}  // namespace hapbench
