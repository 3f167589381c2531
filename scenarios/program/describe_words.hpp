#pragma once

#include <string>
#include <vector>

#include "scenarios/program/describe_results.hpp"

/// What `hapbench describe` says of the words in results that are no fields, metrics or columns.
namespace hapbench {

/// The outcome, the class of motion, the verdict or the number of timing.json of that name. Nothing for other names.
std::vector<Description> describe_word(const std::string& name);

/// The metrics under a heading of the tables of runs, such as ">30Hz rms N" or its first line, ">30Hz"; case and blanks
/// do not matter. Nothing for other names.
std::vector<Description> describe_heading(const std::string& name);

/// The words that describe_word knows.
std::vector<std::string> described_words();

}  // namespace hapbench
