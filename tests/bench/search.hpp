#pragma once

#include <memory>
#include <string>

#include "sim/contact/contact_query.hpp"
#include "tests/bench/task_scene.hpp"

namespace hapbench::bench {

/// The searches that are compared.
inline constexpr const char* kSearches[] = {"brute_force", "grid", "neighbour_list"};

/// Shell and tool must outlive the search.
std::unique_ptr<ContactQuery> make_search(const std::string& search, const PointShell& shell, const ToolShape& tool);

/// Brute force takes 30 us a pose, so it is asked at each 16th pose only; the others, whose answer at a pose may depend
/// on the poses before, are asked at all and compared at each 16th.
inline constexpr std::size_t kBruteForceEvery = 16;

/// What a search answers wrongly along the scene's poses; empty when nothing. Brute force is held against the
/// definition of the tool's body, the others against brute force.
std::string wrong_answers(const std::string& search, const TaskScene& scene);

}  // namespace hapbench::bench
