#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/claims.hpp"

/// Measured numbers of claims as short texts, for tests of the rules that judge them.
namespace hapbench::judged_cases {

/// Returns the claim with this id. Throws std::out_of_range if there is none.
inline const Claim& claim(std::string_view id) {
  static const std::vector<Claim> claims = all_claims();
  for (const Claim& c : claims) {
    if (c.id == id) return c;
  }
  throw std::out_of_range(std::string(id));
}

/// Returns the published numbers together with the recorded values of the assumptions.
inline const PublishedNumbers& published() {
  static const std::filesystem::path reference = HAPBENCH_SCENARIOS "/../../results/reference";
  static const Assumptions assumptions(reference / "assumptions.json");
  static const PublishedNumbers numbers =
      assumptions.with_numbers(PublishedNumbers(reference / "published.json"), assumptions.recorded_values());
  return numbers;
}

/// Sets "name=number,number…" in a case: "1.name=…" in the case with this index; without an index, in all cases that
/// have the name.
inline void set(Measured& measured, std::string_view text) {
  const bool indexed = text.size() > 1 && text[1] == '.';
  const std::size_t equals = text.find('=');
  const std::string name(text.substr(indexed ? 2 : 0, equals - (indexed ? 2 : 0)));
  std::vector<double> numbers;
  for (const std::string_view number : parts_of(text.substr(equals + 1), ','))
    numbers.push_back(std::stod(std::string(number)));
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const bool meant = indexed ? static_cast<std::size_t>(text[0] - '0') == i : measured[i].values.contains(name);
    if (meant) measured[i].values[name] = numbers;
  }
}

/// Returns cases from a text "CASE: name=number … | name=number …". A case inherits the name and the numbers of the
/// case before it unless its text sets them.
inline Measured cases_in(std::string_view text) {
  Measured measured;
  for (std::string_view part : parts_of(text, '|')) {
    MeasuredCase next = measured.empty() ? MeasuredCase() : measured.back();
    if (const std::size_t colon = part.find(':'); colon != part.npos) {
      const std::size_t begin = part.find_first_not_of(' ');
      next.name = part.substr(begin, colon - begin);
      part.remove_prefix(colon + 1);
    }
    measured.push_back(next);
    const std::string index = std::to_string(measured.size() - 1) + ".";
    for (const std::string_view word : words_of(part)) set(measured, index + std::string(word));
  }
  return measured;
}

/// A change of measured numbers, and the verdict after it.
struct Judged {
  std::string_view change;  ///< words for set(), which change the cases of the rule
  Verdict verdict;
};
/// Verdicts on both sides of the thresholds of a rule.
struct Rule {
  std::string_view ids;       ///< claims that have the rule
  std::string_view measured;  ///< text for cases_in()
  std::vector<Judged> judged;
};

/// Returns the measured numbers of a rule after a change.
inline Measured changed_cases(const Rule& rule, std::string_view change) {
  Measured measured = cases_in(rule.measured);
  for (const std::string_view word : words_of(change)) set(measured, word);
  return measured;
}

}  // namespace hapbench::judged_cases
