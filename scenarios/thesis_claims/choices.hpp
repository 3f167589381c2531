#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/thesis_claims/evidence.hpp"

/// Choices that the thesis leaves open and that the bundled scenarios make: results/reference/choices.json.
/// The format of results/reference/choices.json.
namespace hapbench {

/// A field that a choice sets, in the scenarios that have it.
struct ChosenField {
  std::vector<std::string> scenarios;  ///< names of bundled ones; '*' stands for any characters
  std::string path;                    ///< dotted, as in --set; '*' stands for every index of a list
  bool times = false;                  ///< the choice multiplies what the file has, instead of replacing it
};

struct OpenChoice {
  enum class Scale { linear, log };
  enum class Chosen { before, after };

  std::string id;
  std::string what;
  std::string thesis;                               ///< what it says of the matter, or that it does not
  std::variant<double, std::string> value = 0.0;    ///< as the scenarios have it; a text is one of the options
  std::string unit;                                 ///< of a number; empty for a ratio
  std::optional<std::pair<double, double>> range;   ///< plausible values of a number; exactly one of this …
  std::optional<std::vector<std::string>> options;  ///< … and this, texts as in --set
  Scale scale = Scale::linear;                      ///< of the range
  Chosen chosen = Chosen::after;                    ///< before or after results were seen
  std::string why;
  std::vector<ChosenField> fields;  ///< none for a number that rules read by the choice's id
};

/// True when a pattern of a choice's scenarios matches this scenario's name; '*' stands for any characters.
bool names_scenario(std::string_view pattern, std::string_view scenario);

/// All choices on record.
class Choices {
 public:
  /// Reads the file. Throws InputError with file, JSON pointer, the value given and what is allowed.
  explicit Choices(const std::filesystem::path& file);

  const std::vector<OpenChoice>& all() const { return all_; }
  /// FNV-1a of the file's content, as 16 hexadecimal digits; spelling and white space do not count.
  const std::string& hash() const { return hash_; }

  /// What each choice can take: a range in its scale, or its options.
  std::vector<Axis> axes() const;
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

  /// A Markdown table for people.
  std::string markdown() const;

 private:
  std::vector<OpenChoice> all_;
  std::vector<std::string> texts_;  ///< of the choices, as in the file
  std::string hash_;
};

/// The choices of a file. Throws InputError with JSON pointer, the value given and what is allowed.
std::vector<OpenChoice> read_choices(const Json& json);

/// The JSON Schema (draft 7) that results/reference/choices.schema.json holds.
Json choices_schema();

}  // namespace hapbench
