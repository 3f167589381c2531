#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
class ParseError;
}  // namespace CLI

/// What is wrong with words that no command takes.
namespace hapbench {

/// Explains in one line why the command line was refused. Throws InputError for a word that earlier versions took.
std::string usage_problem(const CLI::ParseError& error, const CLI::App& program);
/// Throws InputError for the first word that nothing took and that earlier versions did.
void refuse_old_words(const CLI::App& program, const CLI::App* command);

}  // namespace hapbench
