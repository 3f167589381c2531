#pragma once

#include <filesystem>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// Descriptions of the files installed beside the program: scenarios, studies, claims, assumptions, glossary terms.
namespace hapbench {

/// Describes a scenario by its description, its source and the values that its file sets. The JSON has all
/// fields. Throws InputError if the file is not a valid scenario.
Description describe_scenario(const std::filesystem::path& file, const Layout& layout);
/// Returns entries for the bundled scenarios and studies, the recorded claims and assumptions, and the terms of the
/// glossary. Throws InputError if a file of the claims, the assumptions or the glossary cannot be read.
Index folder_index(const Layout& layout);

}  // namespace hapbench
