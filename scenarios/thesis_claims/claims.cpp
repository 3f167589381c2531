#include "scenarios/thesis_claims/claims.hpp"

namespace hapbench {

std::vector<Claim> all_claims() {
  std::vector<Claim> claims;
  for (const auto chapter :
       {chapter_3_reduction(), chapter_3_cost(), chapter_3_stiffness_ratios(), chapter_3_force_limit(),
        chapter_3_ideal_trajectory(), appendix_a_planar_peg(), appendix_a_springs(), appendix_a_stability(),
        chapter_4_depths(), appendix_b_original_algorithm(), chapter_4_discussion(), appendix_c_proposed_algorithm(),
        chapter_1_penetration(), appendix_f_optional_algorithms(), appendix_d_experiments()}) {
    claims.insert(claims.end(), chapter.begin(), chapter.end());
  }
  return claims;
}

}  // namespace hapbench
