#pragma once

#include <memory>
#include <string>

#include "scenarios/input/json_file.hpp"

namespace hapbench::test {

/// An independent JSON Schema validator (valijson, draft 7).
///
/// valijson 1.0 takes 1e3 and 5.0 for no integers, where draft 7 counts every number with a zero fractional part as one
/// ("integer", JSON Schema Validation 6.1.1), and takes integers of 2^63 and more for negative ones. Documents are
/// handed to it with such numbers written as integers and as floating-point numbers, respectively.
class SchemaValidator {
 public:
  /// Throws std::runtime_error for what is no schema.
  explicit SchemaValidator(const Json& schema);
  ~SchemaValidator();

  bool accepts(const Json& document) const;
  /// Describes what is wrong with a document, for messages of tests; empty when it is valid.
  std::string complaints(const Json& document) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapbench::test
