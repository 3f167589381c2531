#pragma once

#include <memory>
#include <string>

#include "scenarios/input/json_file.hpp"

namespace hapbench::test {

/// An independent JSON Schema validator (valijson, draft 7).
///
/// In draft 7, every number with a zero fractional part is an integer ("integer", JSON Schema Validation
/// 6.1.1). valijson 1.0 differs in two cases: it does not accept 1e3 and 5.0 as integers, and it reads integers
/// of 2^63 and more as negative. Before validation, 1e3 and 5.0 are therefore written as integers, and integers
/// of 2^63 and more as floating-point numbers.
class SchemaValidator {
 public:
  /// Throws std::runtime_error if `schema` is not a valid schema.
  explicit SchemaValidator(const Json& schema);
  ~SchemaValidator();

  /// Returns true if the document is valid.
  bool accepts(const Json& document) const;
  /// Returns a description of what is wrong with a document, for test messages; empty if it is valid.
  std::string complaints(const Json& document) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapbench::test
