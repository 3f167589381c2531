#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// `out`, or results/out/`name` when it is empty.
std::filesystem::path results_directory(const std::string& out, const std::string& name);

/// Throws InputError, which names the option, unless results can be written to `directory`. Creates it, and removes it
/// again if it is still empty when the context goes.
void require_writable_directory(ProgramContext& context, const std::filesystem::path& directory,
                                const std::string& option = "--out");

}  // namespace hapbench
