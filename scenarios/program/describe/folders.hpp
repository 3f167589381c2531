#pragma once

#include <filesystem>

#include "scenarios/program/describe/index.hpp"

/// The descriptions of what lies in the folders beside the program: scenarios, studies, claims, choices.
namespace hapbench {

/// A scenario: where its numbers come from, and what its file sets. Throws InputError.
Description describe_scenario(const std::filesystem::path& file);
/// What the folders beside the program hold: scenarios, studies, claims and choices on record. Throws InputError.
Index folder_index();

}  // namespace hapbench
