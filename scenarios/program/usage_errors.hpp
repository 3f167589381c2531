#pragma once

#include "scenarios/input/input_error.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
class ParseError;
}  // namespace CLI

/// Explains command lines that no command accepts.
namespace hapbench {

/// Returns an error that explains in one line why CLI11 rejected the command line, with the nearest valid name.
/// Its location names the options at fault.
InputError usage_error(const CLI::ParseError& error, const CLI::App& program);

}  // namespace hapbench
