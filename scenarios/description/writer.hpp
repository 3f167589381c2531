#pragma once

#include <nlohmann/json.hpp>

#include "scenarios/description/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Writes a value as JSON. Throws std::logic_error for a value that has no name.
class Writer final : public Fields {
 public:
  /// Which fields to write: all that have a value, or those alone whose default holds for every scenario.
  enum class Which { all, with_default };
  explicit Writer(Which which = Which::all) : which_(which) {}

  /// What was written.
  const Json& json() const { return json_; }

  void number(double& value, NumberRange range) override;
  void integer(std::int64_t& value, IntegerRange range) override;
  void boolean(bool& value) override;
  void text(std::string& value, std::size_t max_length) override;
  void name(std::size_t& index, const std::vector<std::string>& names, const char* what) override;
  void vector3(Vec3& value, NumberRange component) override;
  void pair(const char* allowed, Body first, Body second) override;
  void entries(std::size_t length, ListSize size, FunctionRef<std::size_t> resize,
               FunctionRef<Fields&, std::size_t> entry) override;
  void or_null(bool is_null, FunctionRef<> set_null, Body value) override;
  void number_or_object(bool is_object, Body number, Body object) override;
  void one_or_list(bool is_list, Body one, Body list) override;
  void alternatives(const char* what, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override;
  void fields(Body body) override;

  void field(std::string_view name, const char* doc, Presence presence, Body value) override;
  void ignored(std::string_view name, const char* doc) override;
  void exactly_one_of(const char* a, const char* b) override;

 private:
  Json written(Body value) const;

  Which which_;
  Json json_;
};

/// The JSON of a value, by its `describe`, which says of what kind it is.
template <class T>
Json written(T value) {
  Writer writer;
  describe(writer, value);
  return writer.json();
}

/// The JSON of a struct, by its `describe`.
template <class T>
Json written_object(T value) {
  Writer writer;
  writer.object(value);
  return writer.json();
}

}  // namespace hapbench
