#pragma once

#include <filesystem>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// The descriptions of what lies in the folders beside the program: scenarios, studies, claims, choices.
namespace hapbench {

/// A scenario: where its numbers come from, and what its file sets. Throws InputError.
Description describe_scenario(const std::filesystem::path& file, const Layout& layout);
/// What the folders beside the program hold: scenarios, studies, claims and choices on record. Throws InputError.
Index folder_index(const Layout& layout);

}  // namespace hapbench
