#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/evidence.hpp"
#include "scenarios/thesis_claims/finding.hpp"

/// What the thesis claims, and how each claim is judged from the results of its scenarios.
namespace hapbench {

struct Claim {
  const char* id;
  const char* place;      ///< in the thesis
  const char* claim;      ///< in our words
  const char* published;  ///< its numbers, for people
  const char* rule;       ///< what decides, for people; the code is in results/claims/rules.cpp
  Finding (*judge)(const Evidence& evidence);
  bool timing = false;  ///< the finding holds times, so no two runs agree
};

/// All of them, in the order of the thesis.
std::vector<Claim> all_claims();

/// By chapter.
std::span<const Claim> evaluation_claims();  ///< T, R, L, J
std::span<const Claim> simulation_claims();  ///< A
std::span<const Claim> algorithm_claims();   ///< B, G
std::span<const Claim> discussion_claims();  ///< C, F
std::span<const Claim> experiment_claims();  ///< D

}  // namespace hapbench
