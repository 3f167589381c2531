#pragma once

#include <filesystem>

#include "scenarios/program/program_arguments.hpp"
#include "scenarios/program/program_context.hpp"

/// Commands that Python packages implement.
namespace hapbench {

/// Runs a command of a Python package and returns its exit status. The package receives all arguments after the
/// command's name, including --help. If no host captures the output, this process becomes the Python process
/// and the call does not return.
int run_python_command(const ProgramArguments& arguments, ProgramContext& context);
/// Draws the path of the tool of the run in `folder` into the SVG picture `file`. Throws IoError if the drawing
/// tool fails; the tool then has printed the reason on standard error.
void draw_run(ProgramContext& context, const std::filesystem::path& folder, const std::filesystem::path& file,
              bool quiet);

}  // namespace hapbench
