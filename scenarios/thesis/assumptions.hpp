#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// Assumptions: the values that the thesis leaves open, each with the value that the bundled scenarios have. They are
/// stored in results/reference/assumptions.json; assumptions.schema.json documents the format, and a test validates the
/// file against the schema.
namespace hapbench {

/// A scenario field that an assumption sets.
struct AssumedField {
  std::vector<std::string> scenarios;  ///< names of bundled scenarios; '*' matches any characters
  std::string path;                    ///< dotted, as in --set; '*' matches every index of a list
  /// true: the assumption's value multiplies the value in the scenario; false: it replaces the value in the scenario.
  bool times = false;
};

/// Target of a calibration. `raw` is the published mean number of colliding points over those steps of `scenario` that
/// have a contact.
struct Calibration {
  std::string scenario = {};
  double raw = 0.0;
};

/// One open assumption. Exactly one of `range` and `options` is given.
struct Assumption {
  std::string id = {};
  /// Recorded value as text for --set. The bundled scenarios have this value.
  std::string value = {};
  std::optional<std::pair<double, double>> range = {};  ///< smallest and largest plausible value of a number
  bool logarithmic = false;                             ///< true: the middle of the range is the geometric mean
  std::vector<std::string> options = {};                ///< plausible values of a text, as for --set
  /// Scenario fields that the assumption sets. Empty for a number that the rules of claims read by the assumption's id.
  std::vector<AssumedField> fields = {};
  /// Given if the value follows from a published number of points by calibration. Empty if the value is free.
  std::optional<Calibration> calibration = {};
  std::string text = {};  ///< JSON text of the entry without its prose, for a hash of what can change verdicts

  /// Returns the plausible values other than the recorded value, as texts for --set: the other options, or the ends of
  /// the range and, with `middle`, the middle of the range. Omits a middle that differs from the recorded value by at
  /// most a tenth of the range's width (difference and width of the logarithms if `logarithmic` is true).
  std::vector<std::string> other_values(bool middle = true) const;

  /// Returns true if the assumption can change a claim: it sets a field of one of `scenarios`, or it has no fields and
  /// the text of the claim's `rule` names it, such as <rule.easily>.
  bool reaches(std::span<const std::string> scenarios, const std::string& rule) const;
};

/// All recorded assumptions.
class Assumptions {
 public:
  /// Reads the file. Throws InputError with the JSON pointer of an assumption that lacks a key or has a wrong type.
  explicit Assumptions(const std::filesystem::path& file);

  const std::vector<Assumption>& all() const { return all_; }
  /// Returns the FNV-1a hash of the file's JSON content as 16 hexadecimal digits. White space does not change it.
  const std::string& hash() const { return hash_; }

  /// Returns the recorded values, one for each assumption, as texts for --set.
  std::vector<std::string> recorded_values() const;

  /// Returns the overrides for load_scenario that apply `values`, one for each assumption, to a scenario. Assumptions
  /// that set the same field are applied in order. Throws InputError if an assumption's path is not a field of a
  /// scenario that the assumption names, or if a field to multiply is not a number.
  std::vector<std::string> overrides(const Scenario& scenario, std::span<const std::string> values) const;

  /// Returns `published` together with the values of the assumptions that have no fields. The id of each added number
  /// is the id of its assumption.
  PublishedNumbers with_numbers(PublishedNumbers published, std::span<const std::string> values) const;

  /// Returns a hash of the assumptions that can change a claim (Assumption::reaches). Empty if there are none.
  std::string reach(std::span<const std::string> scenarios, const std::string& rule) const;

 private:
  std::vector<Assumption> all_;
  std::string hash_;
};

/// Returns the JSON Schema (draft 7) of assumptions.json, read from results/reference/assumptions.schema.json. Throws
/// InputError if this file cannot be read.
Json assumptions_schema();

}  // namespace hapbench
