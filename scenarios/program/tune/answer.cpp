#include "scenarios/program/tune/answer.hpp"

#include <algorithm>

#include "scenarios/program/digits.hpp"

namespace hapbench {

std::vector<const TunedLaw*> ranking_of(const std::vector<TunedLaw>& laws) {
  std::vector<const TunedLaw*> ranking;
  for (const TunedLaw& law : laws)
    if (law.choice) ranking.push_back(&law);
  std::ranges::stable_sort(ranking, {}, [](const TunedLaw* law) {
    return value_in(law->choice->metrics, "inside_settled_m").value_or(-law->choice->rendered());
  });
  return ranking;
}

std::string stiffness_text(const TuneTrial& choice) {
  return deserved(choice.stiffness, 0.005 * choice.stiffness);
}

}  // namespace hapbench
