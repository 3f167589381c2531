#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "sim/core/random.hpp"

namespace hapbench::test {

/// A document with one random change, and a description of the change.
struct Mutation {
  Json document;
  std::string change;
};

/// Returns the document with one random change: a key is deleted, added, misspelt or moved; a value is replaced
/// by a value of another type or size; a list is shortened or lengthened; a value is wrapped in a list or
/// object; or a value is replaced by another part of the document.
Mutation mutated(const Json& document, Random& random);

/// Returns the JSON pointers of all values in a document, including the document itself.
std::vector<std::string> pointers_in(const Json& document);

/// Returns the text with a few bytes changed, removed, inserted or repeated at random.
std::string mutated_text(std::string text, Random& random);

}  // namespace hapbench::test
