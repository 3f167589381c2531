#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
class ParseError;
}  // namespace CLI

/// What is wrong with words that no command takes.
namespace hapbench {

/// Returns in one line why CLI11 rejected the command line, with the nearest valid name.
std::string usage_problem(const CLI::ParseError& error, const CLI::App& program);

}  // namespace hapbench
