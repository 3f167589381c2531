#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// Returns `out`, or results/out/`name` if `out` is empty.
std::filesystem::path results_directory(const std::string& out, const std::string& name);

/// Creates the directory. The context's destructor removes it again if it is still empty. Throws InputError,
/// with the option's name, if results cannot be written to it.
void require_writable_directory(ProgramContext& context, const std::filesystem::path& directory,
                                const std::string& option = "--out");

}  // namespace hapbench
