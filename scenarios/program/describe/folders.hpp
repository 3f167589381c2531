#pragma once

#include <filesystem>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// The descriptions of what lies in the folders beside the program: scenarios, studies, claims, choices, terms.
namespace hapbench {

/// A scenario: where its numbers come from, and what its file sets. Throws InputError.
Description describe_scenario(const std::filesystem::path& file, const Layout& layout);
/// Returns what the folders beside the program hold: scenarios, studies, recorded claims and choices, and the terms of
/// the glossary. Throws InputError.
Index folder_index(const Layout& layout);

}  // namespace hapbench
