#pragma once

#include <string>
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

/// The functions that measure a claim and decide its verdict from the measurement alone. A constant in them that is not
/// an assumption must also be stated in the claim's text.
struct ClaimRule {
  const char* id = nullptr;
  Measure measure = nullptr;
  Judge judge = nullptr;
};

/// Returns the rule of a claim that is measured in a single case.
template <MeasuredValues (*measure)(const Evidence&), Finding (*judge)(const MeasuredCase&, const PublishedNumbers&)>
ClaimRule single_case(const char* id) {
  return {id,
          [](const Evidence& e) {
            return Measured{{"", measure(e)}};
          },
          [](const Measured& measured, const PublishedNumbers& p) { return judge(measured.at(0), p); }};
}

/// Returns all claims, in the order of the ledger. Throws InputError if rules.json lacks a key that a claim needs.
std::vector<Claim> all_claims();

/// A sentence of the thesis's abstract, and the claims that test it.
struct AbstractSentence {
  std::string sentence;
  std::vector<std::string> claims;  ///< ids
};

/// Returns the sentences of the abstract that rules.json lists, in the order of the ledger. Throws InputError.
std::vector<AbstractSentence> abstract_sentences();

// The rules of each chapter or appendix, defined in the source file of the same name, with the ids of their claims.

std::vector<ClaimRule> chapters_1_and_4();        ///< V, S1, S3, B1b, B5, G, B4, C1 to C3, C7, C8
std::vector<ClaimRule> chapter_3_counts();        ///< T1 to T3
std::vector<ClaimRule> chapter_3_stiffness();     ///< R
std::vector<ClaimRule> chapter_3_force_limit();   ///< L
std::vector<ClaimRule> chapter_3_trajectory();    ///< J, C5, T2b
std::vector<ClaimRule> chapter_3_cost();          ///< T4, T5, P2, F3
std::vector<ClaimRule> whole_tasks();             ///< S2, T6, G3
std::vector<ClaimRule> appendix_a();              ///< A
std::vector<ClaimRule> appendix_b_c_f();          ///< B1 to B3, P1, C6, F1, F2, F4, F5
std::vector<ClaimRule> appendix_d_experiments();  ///< D

}  // namespace hapbench
