#include "scenarios/thesis/judging.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"

namespace hapbench {

Finding Claim::judged(const Measured& cases, const PublishedNumbers& numbers_of_thesis) const {
  Finding finding = judge(cases, numbers_of_thesis);
  // Insert the measured numbers into the texts; a list of numbers is replaced by its mean. <NAME> is the number NAME of
  // the latest case so far, <CASE.NAME> the number NAME of the case CASE.
  PublishedNumbers numbers = numbers_of_thesis;
  std::string of_cases;
  for (const MeasuredCase& m : cases) {
    for (const auto& [name, values] : m.values)
      for (const std::string& of_case : {name, m.name + "." + name}) numbers.set(of_case, mean_of(values));
    std::string text = each;
    if (const std::size_t gap = text.find("{}"); gap != std::string::npos) text.replace(gap, 2, m.name);
    if (!each.empty()) append_item(of_cases, numbers.fill(text));
  }
  if (finding.measured.empty()) finding.measured = numbers.fill(measured) + of_cases;
  if (finding.number.empty()) finding.number = numbers.fill(number);
  finding.cases = cases;
  return finding;
}

const Measurements::Made& Measurements::made(Measure measure, const Evidence& evidence) {
  auto found = made_.find(measure);
  if (found == made_.end()) {
    Made made;
    Evidence noting = evidence;
    noting.used = [&made](const std::string& scenario) { made.scenarios.push_back(scenario); };
    noting.provide = [&](const std::string& scenario) {
      made.scenarios.push_back(scenario);
      evidence.provide(scenario);
    };
    try {
      made.cases = measure(noting);
    } catch (const NothingToMeasure& missing) {
      made.nothing = missing.what();
    }
    found = made_.emplace(measure, std::move(made)).first;
  }
  if (evidence.used) std::ranges::for_each(found->second.scenarios, evidence.used);
  return found->second;
}

Finding Measurements::finding(const Claim& claim, const Evidence& evidence) {
  if (claim.judge == nullptr) return {Verdict::not_testable, claim.why};
  const Made& now = made(claim.measure, evidence);
  Finding finding =
      now.nothing.empty() ? claim.judged(now.cases, evidence.published) : Finding{Verdict::not_judged, now.nothing};
  if (claim.earlier.judge == nullptr) return finding;
  const Made& before = claim.earlier.measure == nullptr ? now : made(claim.earlier.measure, evidence);
  finding.earlier =
      before.nothing.empty() ? claim.earlier.judge(before.cases, evidence.published) : Verdict::not_judged;
  return finding;
}

}  // namespace hapbench
