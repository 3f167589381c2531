#pragma once

#include <filesystem>

#include "scenarios/program/program_context.hpp"
#include "scenarios/program/program_words.hpp"

/// Commands whose work packages in Python do.
namespace hapbench {

/// Runs a command of a Python package, which takes every word behind the name, --help included.
int run_python_command(const ProgramWords& words, ProgramContext& context);
/// Draws the run in a folder into FILE.svg. Throws IoError, after the Python tool has said why on standard error.
void write_way(ProgramContext& context, const std::filesystem::path& folder, const std::filesystem::path& file,
               bool quiet);

}  // namespace hapbench
