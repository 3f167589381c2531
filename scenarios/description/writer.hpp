#pragma once

#include <nlohmann/json.hpp>

#include "scenarios/description/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Writes a value as JSON. Throws std::logic_error for a value that has no name.
class Writer final : public Fields {
 public:
  /// Selects the fields to write: all that have a value, or only those whose default holds for every scenario.
  enum class Which { all, with_default };
  explicit Writer(Which which = Which::all) : which_(which) {}

  /// The written JSON.
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
  void plain_or_object(bool is_object, Body plain, Body object) override;
  void any_object(std::string& json) override;
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

/// The names of the types.
std::vector<std::string> names_of(std::span<const TypeName> types);

struct FieldGuide;

/// The values that are allowed: as a JSON Schema (draft 7), in words for messages and documentation, and by the fields
/// of an object.
struct ValueGuide {
  Json schema;
  std::string allowed;              ///< as in "a number > 0 and <= 10 [m]"
  std::vector<FieldGuide> fields;   ///< of an object whose fields no type chooses, or that is of one type
  std::vector<ValueGuide> choices;  ///< the objects among which a field "type" chooses
  std::string type, summary;        ///< of such an object: its type, and what that is in a few words
  bool may_be_untyped = false;      ///< of such an object: it may stand without its type
};

/// A field of an object.
struct FieldGuide {
  std::string name;
  std::string meaning;
  Presence presence;
  Json initial;  ///< the default, with Presence::has_default
  ValueGuide value;

  /// The schema of the value with meaning and default.
  Json schema() const;
};

/// Describes which values are allowed. Defaults are the values of the object it visits, which has to be a
/// default-constructed one.
class SchemaWriter final : public Fields {
 public:
  /// `words`: of the value itself, what allowed() says, and nothing of the fields of an object; for a message.
  enum class Extent { whole, words };

  /// With `definitions`, values that are described alike in many places are put there once, by their names, and the
  /// schema refers to "#/definitions/NAME".
  explicit SchemaWriter(Json* definitions = nullptr, Extent extent = Extent::whole)
      : definitions_(definitions), extent_(extent) {}

  const ValueGuide& guide() const { return guide_; }
  const Json& schema() const { return guide_.schema; }
  const std::string& allowed() const { return guide_.allowed; }

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
  void plain_or_object(bool is_object, Body plain, Body object) override;
  void any_object(std::string& json) override;
  void one_or_list(bool is_list, Body one, Body list) override;
  void alternatives(const char* what, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override;
  void fields(Body body) override;
  void shared(const char* name, Body value) override;

  void field(std::string_view name, const char* doc, Presence presence, Body value) override;
  void ignored(std::string_view name, const char* doc) override;
  /// Throws std::logic_error for a second pair, for which the schema has no place.
  void exactly_one_of(const char* a, const char* b) override;

 private:
  ValueGuide guide_of(Body value) const;
  void any_of(ValueGuide first, ValueGuide second);

  Json* definitions_;
  Extent extent_;
  ValueGuide guide_;
};

/// The whole JSON Schema (draft 7) that scenarios/scenario.schema.json holds.
Json scenario_schema();

/// The guide to a scenario in full, that is, with the fields of the scenario that it extends filled in. It is built
/// once, and again after an algorithm has been added; references stay valid. For several threads.
const ValueGuide& scenario_guide();

/// The dotted paths of all fields of objects, as "rendering.limits.max_force_N"; those of list entries aside.
const std::vector<std::string>& scenario_field_paths();

}  // namespace hapbench
