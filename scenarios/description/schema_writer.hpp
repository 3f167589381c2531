#pragma once

#include <nlohmann/json.hpp>

#include "scenarios/description/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// The field that chooses the alternative of an object.
inline constexpr const char* kTypeField = "type";

/// Writes which values are allowed: as a JSON Schema (draft 7), and in words for messages. Defaults are the values of
/// the object it visits, which has to be a default-constructed one.
class SchemaWriter final : public Fields {
 public:
  const Json& schema() const { return schema_; }
  /// As in "a number > 0 and <= 10 [m]".
  const std::string& allowed() const { return allowed_; }

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
  void alternatives(const char* what, std::span<const char* const> names, Untyped untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override;
  void fields(Body body) override;

  void field(std::string_view name, const char* doc, Presence presence, Body value) override;
  void ignored(std::string_view name, const char* doc) override;
  /// Throws std::logic_error for a second pair, for which the schema has no place.
  void exactly_one_of(const char* a, const char* b) override;

 private:
  void any_of(Body first, const char* between, Body second);

  Json schema_;
  std::string allowed_;
  std::vector<std::string> names_;  ///< of the object's fields
};

}  // namespace hapbench
