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

/// Choices that the thesis leaves open and that the bundled scenarios make. results/reference/choices.json has them;
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
  std::string text = {};                                ///< all of it, as in the file
};

/// All choices on record.
class Choices {
 public:
  /// Reads the file. Throws InputError with the JSON pointer of a choice that lacks a part or has another type of it.
  explicit Choices(const std::filesystem::path& file);

  const std::vector<OpenChoice>& all() const { return all_; }
  /// FNV-1a of the file's content, as 16 hexadecimal digits; spelling and white space do not count.
  const std::string& hash() const { return hash_; }

  /// Returns the values on record, one for each choice, as texts for --set.
  std::vector<std::string> values_on_record() const;

  /// Returns the changes that these values, one for each choice, make to a scenario, as overrides for load_scenario.
  /// Choices of one field are applied in order. Throws InputError when a choice's path is no field of a scenario that
  /// it names, or a field to multiply is no number.
  std::vector<std::string> overrides(const Scenario& scenario, std::span<const std::string> values) const;

  /// Returns the published numbers and the numbers of the choices without fields.
  PublishedNumbers with_numbers(PublishedNumbers published, std::span<const std::string> values) const;

  /// Returns a hash of the choices that reach a claim: choices that concern one of these scenarios, and numbers that
  /// the rule's text names, as in <rule.easily>. Empty when none does.
  std::string reach(std::span<const std::string> scenarios, const std::string& rule) const;

 private:
  std::vector<OpenChoice> all_;
  std::string hash_;
};

/// Returns the JSON Schema (draft 7) of choices.json, results/reference/choices.schema.json. Throws InputError.
Json choices_schema();

}  // namespace hapbench
