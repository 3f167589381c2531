#pragma once

#include <string>
#include <utility>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/judging.hpp"
#include "sim/tool/cylinder.hpp"

/// The list of all claims. Their texts are in results/reference/rules.json, the published numbers in published.json.
/// The source file of each chapter measures the claims and decides the verdicts.
namespace hapbench {

/// The functions that measure a claim and decide its verdict from the measurement alone. If one of these functions has
/// a constant that is not an assumption, the claim's text must state the constant too.
struct ClaimRule {
  const char* id = nullptr;
  Measure measure = nullptr;
  Judge judge = nullptr;
  EarlierRule earlier = {};  ///< without its texts, which are in rules.json
};

/// Returns the rule of a claim that is measured in a single case.
template <MeasuredValues (*measure)(const Evidence&), Finding (*judge)(const MeasuredCase&, const PublishedNumbers&)>
ClaimRule single_case(const char* id, EarlierRule earlier = {}) {
  return {id,
          [](const Evidence& e) {
            return Measured{{"", measure(e)}};
          },
          [](const Measured& measured, const PublishedNumbers& p) { return judge(measured.at(0), p); },
          std::move(earlier)};
}

/// Returns all claims, in the order of the ledger. Throws InputError if rules.json lacks a key that a claim needs.
std::vector<Claim> all_claims();

/// A sentence of the thesis's abstract, and the claims that test it.
struct AbstractSentence {
  std::string sentence;
  std::vector<std::string> claims;  ///< ids of the claims
};

/// Returns the sentences of the abstract that rules.json lists, in the order of the ledger. Throws InputError if
/// rules.json cannot be read or lacks a key.
std::vector<AbstractSentence> abstract_sentences();

// The rules of each chapter or appendix, defined in the source file of the same name, with the ids of their claims.

std::vector<ClaimRule> chapters_1_and_4();        ///< V1, V2, S1, B1b, B4, B5, G1, G1b, G2, C1 to C3, C7, C8
std::vector<ClaimRule> chapter_3_counts();        ///< T1 to T3
std::vector<ClaimRule> chapter_3_stiffness();     ///< R1 to R6, R1b, S3, F5
std::vector<ClaimRule> chapter_3_force_limit();   ///< L1 to L4
std::vector<ClaimRule> chapter_3_trajectory();    ///< J1, J2, C5, T2b
std::vector<ClaimRule> chapter_3_cost();          ///< T4, T4b, T5, P2, F3
std::vector<ClaimRule> whole_tasks();             ///< S2, G3
std::vector<ClaimRule> appendix_a();              ///< A1 to A6
std::vector<ClaimRule> appendix_b_c_f();          ///< B1 to B3, P1, T6, C6, F1, F2, F4
std::vector<ClaimRule> appendix_d_experiments();  ///< D1 to D4, D6, D7

}  // namespace hapbench
