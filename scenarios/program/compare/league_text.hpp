#pragma once

#include <string>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/layout.hpp"

/// What `compare` prints of a league.
namespace hapbench {

/// The standings, best first, the algorithms over all of them, and what that says.
std::string league_text(const League& league, const Layout& layout);

}  // namespace hapbench
