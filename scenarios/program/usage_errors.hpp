#pragma once

#include "scenarios/input/input_error.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
class ParseError;
}  // namespace CLI

/// What is wrong with words that no command takes.
namespace hapbench {

/// Returns an error that explains in one line why the command line was refused, and that is about the options at fault.
/// Throws InputError for a word that earlier versions took.
InputError usage_error(const CLI::ParseError& error, const CLI::App& program);
/// Throws InputError for the first word that nothing took and that earlier versions did.
void refuse_old_words(const CLI::App& program, const CLI::App* command);

}  // namespace hapbench
