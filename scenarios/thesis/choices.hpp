#pragma once

#include <optional>
#include <span>
#include <utility>

#include "scenarios/thesis/claims.hpp"

/// Choices that the thesis leaves open and that the bundled scenarios make: results/reference/choices.json.
/// choices.schema.json beside it says what each part means and what is allowed; a test checks the file by it.
namespace hapbench {

/// A field that a choice sets, in the scenarios that have it.
struct ChosenField {
  std::vector<std::string> scenarios;  ///< names of bundled ones; '*' stands for any characters
  std::string path;                    ///< dotted, as in --set; '*' stands for every index of a list
  bool times = false;                  ///< the choice multiplies what the file has, instead of replacing it
};

struct OpenChoice {
  std::string id = {};
  std::string value = {};                               ///< as the scenarios have it, a text as in --set
  std::optional<std::pair<double, double>> range = {};  ///< plausible values of a number; exactly one of this …
  std::vector<std::string> options = {};                ///< … and these, texts as in --set
  std::vector<ChosenField> fields = {};                 ///< none for a number that rules read by the choice's id
};

/// True when a pattern of a choice's scenarios matches this scenario's name; '*' stands for any characters.
bool names_scenario(const std::string& pattern, const std::string& scenario);

/// All choices on record.
class Choices {
 public:
  /// Reads the file. Throws InputError with file and JSON pointer of a choice that lacks a part or has another type of
  /// it.
  explicit Choices(const std::filesystem::path& file);

  const std::vector<OpenChoice>& all() const { return all_; }
  /// FNV-1a of the file's content, as 16 hexadecimal digits; spelling and white space do not count.
  const std::string& hash() const { return hash_; }

  /// The values on record, one for each choice, as texts for --set.
  std::vector<std::string> values_on_record() const;

  /// Returns the changes that these values make to a scenario, as overrides "path=value" for load_scenario. Choices
  /// that concern the same field are applied in order. Throws InputError when a choice's path is no field of a scenario
  /// that it names, or a field to multiply is no number. Precondition: one value for each choice.
  std::vector<std::string> overrides(const Scenario& scenario, std::span<const std::string> values) const;

  /// The published numbers and those of the choices without fields.
  PublishedNumbers with_numbers(PublishedNumbers published, std::span<const std::string> values) const;

  /// Hash of the choices that reach a claim: those that concern one of these scenarios, and numbers that the rule's
  /// text names, as in <rule.easily>. Empty when none does.
  std::string reach(std::span<const std::string> scenarios, const std::string& rule) const;

 private:
  std::vector<OpenChoice> all_;
  std::vector<std::string> texts_;  ///< of the choices, as in the file
  std::string hash_;
};

/// The JSON Schema (draft 7) of that file, results/reference/choices.schema.json. Throws InputError.
Json choices_schema();

}  // namespace hapbench
