#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "sim/core/random.hpp"

namespace hapbench::test {

/// A document in which one thing was changed at random, and what that was.
struct Mutation {
  Json document;
  std::string change;
};

/// Deletes, adds, misspells or moves a key, replaces a value by one of another type or size, cuts or lengthens a list,
/// wraps a value, or puts another part of the document in its place.
Mutation mutated(const Json& document, Random& random);

/// JSON pointers of all values in a document, the document itself included.
std::vector<std::string> pointers_in(const Json& document);

/// A text in which a few bytes were changed, removed, inserted or repeated at random.
std::string mutated_text(std::string text, Random& random);

}  // namespace hapbench::test
