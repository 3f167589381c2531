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

/// Choices: assumptions that the thesis leaves open and that the bundled scenarios make. They are stored in
/// results/reference/choices.json; choices.schema.json documents the format, and a test validates the file against it.
namespace hapbench {

/// A scenario field that a choice sets.
struct ChosenField {
  std::vector<std::string> scenarios;  ///< names of bundled scenarios; '*' matches any characters
  std::string path;                    ///< dotted, as in --set; '*' matches every index of a list
  bool times = false;                  ///< true: the choice's value multiplies the value in the scenario; false: it
                                       ///< replaces this value
};

/// One open assumption. Exactly one of `range` and `options` is given.
struct OpenChoice {
  std::string id = {};
  std::string value = {};                               ///< recorded value as text for --set; the bundled scenarios
                                                        ///< have this value
  std::optional<std::pair<double, double>> range = {};  ///< smallest and largest plausible value of a number
  std::vector<std::string> options = {};                ///< plausible values of a text, as for --set
  std::vector<ChosenField> fields = {};  ///< empty for a number that rules of claims read by the choice's id
  std::string text = {};                 ///< JSON text of the whole entry
};

/// All recorded choices.
class Choices {
 public:
  /// Reads the file. Throws InputError with the JSON pointer of a choice that lacks a key or has a wrong type.
  explicit Choices(const std::filesystem::path& file);

  const std::vector<OpenChoice>& all() const { return all_; }
  /// Returns the FNV-1a hash of the file's JSON content as 16 hexadecimal digits. White space does not change it.
  const std::string& hash() const { return hash_; }

  /// Returns the recorded values, one for each choice, as texts for --set.
  std::vector<std::string> values_on_record() const;

  /// Returns the overrides for load_scenario that apply `values`, one for each choice, to a scenario. Choices that set
  /// the same field are applied in order. Throws InputError if a choice's path is not a field of a scenario that the
  /// choice names, or if a field to multiply is not a number.
  std::vector<std::string> overrides(const Scenario& scenario, std::span<const std::string> values) const;

  /// Returns `published` with the values of the choices without fields added, by the choices' ids.
  PublishedNumbers with_numbers(PublishedNumbers published, std::span<const std::string> values) const;

  /// Returns a hash of the choices that influence a claim: choices that set a field of one of `scenarios`, and choices
  /// without fields that the text of the claim's `rule` names, such as <rule.easily>. Empty if there are none.
  std::string reach(std::span<const std::string> scenarios, const std::string& rule) const;

 private:
  std::vector<OpenChoice> all_;
  std::string hash_;
};

/// Returns the JSON Schema (draft 7) of choices.json, results/reference/choices.schema.json. Throws InputError.
Json choices_schema();

}  // namespace hapbench
