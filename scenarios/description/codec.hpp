#pragma once

#include <memory>
#include <string>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

/// One description of a scenario's fields serves three purposes: it reads and checks JSON into a plain struct, writes
/// the struct back (the effective scenario) and emits the JSON Schema. Program and schema cannot disagree.
namespace hapbench {

/// Reads, writes and describes values of type T.
template <class T>
class Codec {
 public:
  virtual ~Codec() = default;
  /// Reads `json`, found at JSON pointer `at`, into `out`; fields that are absent leave `out` as it is. Throws
  /// InputError.
  virtual void read(const Json& json, const std::string& at, T& out) const = 0;
  virtual Json write(const T& value) const = 0;
  /// JSON Schema, draft 7.
  virtual Json schema() const = 0;
  /// What is allowed, in words: "a number > 0 [m]".
  virtual std::string allowed() const = 0;
};

template <class T>
using CodecPtr = std::shared_ptr<const Codec<T>>;

/// Throws the error "got VALUE; allowed: …" for a field of the wrong type or range.
[[noreturn]] void refuse(const Json& json, const std::string& at, const std::string& allowed,
                         const std::string& hint = "");

}  // namespace hapbench
