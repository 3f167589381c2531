#include "scenarios/input/json_schema.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"

namespace hapbench {
namespace {

/// Visitor that builds the documentation of a value. Implements guide_to.
class SchemaWriter final : public Fields {
 public:
  explicit SchemaWriter(Json* definitions) : definitions_(definitions) {}

  ValueGuide guide(Body value) && {
    value(*this);
    return std::move(guide_);
  }

  void number(double&, NumberRange range) override {
    guide_.schema = {
        {"type", "number"}, {range.above_min ? "exclusiveMinimum" : "minimum", range.min}, {"maximum", range.max}};
    const std::string unit = *range.unit == '\0' ? "" : fmt::format(" [{}]", range.unit);
    guide_.allowed =
        fmt::format("a number {} {} and <= {}{}", range.above_min ? ">" : ">=", range.min, range.max, unit);
  }
  void integer(std::int64_t&, IntegerRange range) override {
    guide_.schema = {{"type", "integer"}, {"minimum", range.min}, {"maximum", range.max}};
    guide_.allowed = fmt::format("an integer {} ... {}", range.min, range.max);
  }
  void boolean(bool&) override {
    guide_.schema = {{"type", "boolean"}};
    guide_.allowed = "true or false";
  }
  void text(std::string&, std::size_t max_length) override {
    guide_.schema = {{"type", "string"}, {"maxLength", max_length}};
    guide_.allowed = fmt::format("a text of at most {} characters", max_length);
  }
  void any_object(std::string&) override {
    guide_.schema = {{"type", "object"}};
    guide_.allowed = "an object";
  }
  void name(std::size_t&, const std::vector<std::string>& names, const char* what) override {
    guide_.schema = {{"type", "string"}, {"enum", names}};
    guide_.allowed = fmt::format("{}: one of {}", what, quoted_list(names));
  }
  void vector3(Vec3& value, NumberRange component) override {
    const ValueGuide item = guide_to_number(value.x(), component);
    guide_.schema = {{"type", "array"}, {"items", item.schema}, {"minItems", 3}, {"maxItems", 3}};
    guide_.allowed = "three numbers [x, y, z], each " + item.allowed;
  }
  void pair(const char* allowed, double& first, NumberRange of_first, double& second, NumberRange of_second) override {
    const Json items = {guide_to_number(first, of_first).schema, guide_to_number(second, of_second).schema};
    guide_.schema = {{"type", "array"}, {"items", items}, {"minItems", 2}, {"maxItems", 2}};
    guide_.allowed = allowed;
  }
  void entries(std::size_t length, ListSize size, FunctionRef<std::size_t>,
               FunctionRef<Fields&, std::size_t> entry) override {
    const ValueGuide item = guide_of([&](Fields& f) { entry(f, length); });
    guide_.schema = {{"type", "array"}, {"items", item.schema}, {"minItems", size.min}, {"maxItems", size.max}};
    guide_.allowed = fmt::format("a list of {} ... {} entries, each {}", size.min, size.max, item.allowed);
  }
  void or_null(bool, FunctionRef<>, Body value) override {
    guide_ = guide_of(value);
    guide_.schema = {{"anyOf", {{{"type", "null"}}, guide_.schema}}};
    guide_.allowed = "null or " + guide_.allowed;
  }
  void plain_or_object(bool, Body plain, Body object) override { any_of(guide_of(plain), guide_of(object)); }
  void one_or_list(bool, Body one, Body list) override { any_of(guide_of(one), guide_of(list)); }
  void alternatives(const char*, std::span<const TypeName> types, Untyped untyped, std::size_t,
                    FunctionRef<Fields&, std::size_t> fields) override {
    guide_.allowed =
        fmt::format("an object whose \"{}\" is one of {}", kTypeField, quoted_list(names_of(types, &TypeName::name)));
    // Document each type with a separate writer.
    Json schemas = Json::array();
    for (std::size_t i = 0; i < types.size(); ++i) {
      SchemaWriter choice(definitions_);
      choice.guide_.type = types[i].name;
      choice.guide_.summary = types[i].summary;
      choice.guide_.may_be_untyped = untyped == Untyped::first && i == 0;
      choice.fields([&](Fields& f) { fields(f, i); });
      schemas.push_back(choice.guide_.schema);
      guide_.choices.push_back(std::move(choice.guide_));
    }
    // The value must have one of the types.
    guide_.schema = {{"oneOf", std::move(schemas)}};
  }
  void fields(Body body) override {
    // Start with an object without fields.
    guide_.schema = {{"type", "object"},
                     {"properties", Json::object()},
                     {"additionalProperties", false},
                     {"required", Json::array()}};
    // Add the field "type" if the object is one alternative of several.
    if (!guide_.type.empty()) {
      guide_.schema["properties"][kTypeField] = {{"const", guide_.type}};
      if (!guide_.may_be_untyped) guide_.schema["required"].push_back(kTypeField);
    }
    // Add the other fields: `body` calls field() for each.
    body(*this);
    if (guide_.schema["required"].empty()) guide_.schema.erase("required");
    guide_.allowed = "an object with the fields " + quoted_list(names_of(guide_.fields, &FieldGuide::name));
  }
  void shared(const char* name, Body value) override {
    guide_ = guide_of(value);
    if (definitions_ == nullptr) return;
    (*definitions_)[name] = std::move(guide_.schema);
    guide_.schema = {{"$ref", std::string("#/definitions/") + name}};
  }
  void field(std::string_view name, const char* doc, Presence presence, Body value) override {
    FieldGuide field{
        .name = std::string(name), .meaning = doc, .presence = presence, .initial = {}, .value = guide_of(value)};
    if (presence == Presence::has_default) field.initial = default_of(value);
    guide_.schema["properties"][field.name] = field.schema();
    if (presence == Presence::required) guide_.schema["required"].push_back(field.name);
    guide_.fields.push_back(std::move(field));
  }
  void ignored(std::string_view name, const char* doc) override {
    guide_.schema["properties"][std::string(name)] = {{"description", doc}};
    guide_.fields.push_back(
        {.name = std::string(name), .meaning = doc, .presence = Presence::omitted, .initial = {}, .value = {}});
  }
  void exactly_one_of(const char* a, const char* b) override {
    Json& schema = guide_.schema;
    if (schema.contains("oneOf")) throw std::logic_error("exactly_one_of twice in one object");
    schema["oneOf"] = Json::array({Json{{"required", {a}}}, Json{{"required", {b}}}});
  }

 private:
  ValueGuide guide_of(Body value) const { return SchemaWriter(definitions_).guide(value); }
  ValueGuide guide_to_number(double& value, NumberRange range) const {
    return guide_of([&](Fields& f) { f.number(value, range); });
  }
  /// Documents a value that is either `first` or `second`. Keeps the fields of `second`, which may be an object.
  void any_of(ValueGuide first, ValueGuide second) {
    guide_ = std::move(second);
    guide_.schema = {{"anyOf", {first.schema, guide_.schema}}};
    guide_.allowed = first.allowed + ", or " + guide_.allowed;
  }

  Json* definitions_;  ///< definitions of shared values; null: no definitions are written
  ValueGuide guide_;   ///< documentation of the visited value
};

}  // namespace

Json FieldGuide::schema() const {
  Json entry = value.schema;
  // JSON Schema draft 7 ignores all keys next to "$ref". Therefore the reference is wrapped in "allOf".
  if (entry.contains("$ref")) entry = {{"allOf", Json::array({std::move(entry)})}};
  entry["description"] = meaning;
  if (presence == Presence::has_default) entry["default"] = initial;
  return entry;
}

ValueGuide guide_to(Fields::Body value, Json* definitions) {
  return SchemaWriter(definitions).guide(value);
}

}  // namespace hapbench
