#include "scenarios/thesis_claims/claims.hpp"

namespace hapbench {

std::vector<Claim> all_claims() {
  std::vector<Claim> claims;
  for (const auto group :
       {evaluation_claims(), simulation_claims(), algorithm_claims(), discussion_claims(), experiment_claims()}) {
    claims.insert(claims.end(), group.begin(), group.end());
  }
  return claims;
}

}  // namespace hapbench
