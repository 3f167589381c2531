#pragma once

#include <string>

#include "scenarios/program/layout.hpp"
#include "scenarios/program/tune/answer.hpp"

/// The printed text of `tune`.
namespace hapbench {

/// Returns the question, the recommendation, the table of the laws, and the reason why a law has no feasible
/// choice.
std::string tuning_text(const Tuning& tuning, const Layout& layout);

}  // namespace hapbench
