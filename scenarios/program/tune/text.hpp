#pragma once

#include <string>

#include "scenarios/program/layout.hpp"
#include "scenarios/program/tune/answer.hpp"

/// What `tune` prints.
namespace hapbench {

/// The question, the recommendation, the table of the laws, and why a law has no choice.
std::string tuning_text(const Tuning& tuning, const Layout& layout);

}  // namespace hapbench
