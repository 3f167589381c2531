#include "scenarios/thesis/judging.hpp"

#include <cstddef>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"

namespace hapbench {

Finding Claim::finding(const Evidence& evidence) const {
  if (judge == nullptr) return {Verdict::not_reproducible, why};
  // Measure and judge.
  const Measured cases = measure(evidence);
  Finding finding = judge(cases, evidence.published);
  // Insert the measured numbers into the texts. NAME refers to the latest case so far, CASE.NAME to the given case.
  PublishedNumbers numbers = evidence.published;
  std::string of_cases;
  for (const MeasuredCase& m : cases) {
    for (const auto& [name, values] : m.values)
      for (const std::string& of_case : {name, m.name + "." + name}) numbers.set(of_case, mean_of(values));
    std::string text = each;
    if (const std::size_t gap = text.find("{}"); gap != std::string::npos) text.replace(gap, 2, m.name);
    if (!each.empty()) append_item(of_cases, numbers.fill(text));
  }
  if (finding.measured.empty()) finding.measured = numbers.fill(measured) + of_cases;
  finding.brief = numbers.fill(main.ours);
  finding.cases = cases;
  return finding;
}

}  // namespace hapbench
