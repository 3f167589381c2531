#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/evidence.hpp"
#include "scenarios/thesis_claims/finding.hpp"
#include "scenarios/thesis_claims/measured.hpp"

/// What the thesis claims, and how each claim is judged. All of a claim stands together in the file of its chapter: its
/// text, what is measured, the thresholds and the rule. A new claim is an entry there, and its published numbers are
/// one in results/reference/published.
namespace hapbench {

struct Claim {
  const char* id;
  const char* place;      ///< in the thesis
  const char* claim;      ///< in our words
  const char* published;  ///< its numbers, for people
  /// What decides, for people: written from the thresholds and published numbers that `judge` compares with.
  std::string (*rule)(const PublishedNumbers& published);
  /// Takes what decides from the results of scenarios, or computes it.
  Measured (*measure)(const Evidence& evidence);
  /// Depends on its arguments alone.
  Finding (*judge)(const Measured& measured, const PublishedNumbers& published);
  bool timing = false;  ///< the finding holds times, so no two runs agree
  bool costly = false;  ///< takes long to measure: judged again for a part of a sample only (robustness.hpp)
};

/// All of them, in the order of the ledger.
std::vector<Claim> all_claims();

/// What the thesis proposes.
inline constexpr const char* kProposedLaw = "shaped_stiffness";

/// By chapter.
std::span<const Claim> chapter_1_penetration();           ///< V
std::span<const Claim> chapter_3_reduction();             ///< T1 to T3
std::span<const Claim> chapter_3_cost();                  ///< T4, T5
std::span<const Claim> chapter_3_stiffness_ratios();      ///< R
std::span<const Claim> chapter_3_force_limit();           ///< L
std::span<const Claim> chapter_3_ideal_trajectory();      ///< J
std::span<const Claim> chapter_4_depths();                ///< G
std::span<const Claim> chapter_4_discussion();            ///< B4, C1 to C4
std::span<const Claim> appendix_a_planar_peg();           ///< A1
std::span<const Claim> appendix_a_springs();              ///< A2, A3
std::span<const Claim> appendix_a_stability();            ///< A4
std::span<const Claim> appendix_b_original_algorithm();   ///< B1 to B3
std::span<const Claim> appendix_c_proposed_algorithm();   ///< P, C5, C6
std::span<const Claim> appendix_d_experiments();          ///< D
std::span<const Claim> appendix_f_optional_algorithms();  ///< F

}  // namespace hapbench
