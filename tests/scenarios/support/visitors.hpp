#pragma once

#include <gtest/gtest.h>

#include <string>

#include "scenarios/format/fields.hpp"
#include "scenarios/format/writer.hpp"
#include "tests/scenarios/support/errors.hpp"

/// Applies the three visitors to a value that `describe(Fields&, T&)` describes.
namespace hapbench::test {

/// Reads a JSON text, found at `at`, into `value`.
template <class T, class Describe>
void read_json(const Json& json, const std::string& at, T& value, Describe describe) {
  read_value(json, at, [&](Fields& f) { describe(f, value); });
}

/// The message with which a JSON text, found at "/v", is refused for its shape.
template <class T, class Describe>
std::string refusal_of(const std::string& text, T value, Describe describe) {
  SCOPED_TRACE(text);
  const auto error = input_error_of([&] { read_json(Json::parse(text), "/v", value, describe); });
  if (!error) return "";
  EXPECT_EQ(error->kind(), InputError::Kind::shape);
  return error->what();
}

template <class T, class Describe>
Json written_by(Describe describe, T value) {
  return json_of([&](Fields& f) { describe(f, value); });
}

template <class T, class Describe>
Json schema_of(Describe describe, T value) {
  return guide_to([&](Fields& f) { describe(f, value); }).schema;
}

}  // namespace hapbench::test
