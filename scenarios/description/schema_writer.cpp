#include "scenarios/description/schema_writer.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "scenarios/description/writer.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

SchemaWriter described(Fields::Body value) {
  SchemaWriter writer;
  value(writer);
  return writer;
}

}  // namespace

void SchemaWriter::number(double&, NumberRange range) {
  schema_ = {{"type", "number"}, {range.above_min ? "exclusiveMinimum" : "minimum", range.min}, {"maximum", range.max}};
  const std::string unit = *range.unit == '\0' ? "" : fmt::format(" [{}]", range.unit);
  allowed_ = fmt::format("a number {} {} and <= {}{}", range.above_min ? ">" : ">=", range.min, range.max, unit);
}

void SchemaWriter::integer(std::int64_t&, IntegerRange range) {
  schema_ = {{"type", "integer"}, {"minimum", range.min}, {"maximum", range.max}};
  allowed_ = fmt::format("an integer {} ... {}", range.min, range.max);
}

void SchemaWriter::boolean(bool&) {
  schema_ = {{"type", "boolean"}};
  allowed_ = "true or false";
}

void SchemaWriter::text(std::string&, std::size_t max_length) {
  schema_ = {{"type", "string"}, {"maxLength", max_length}};
  allowed_ = fmt::format("a text of at most {} characters", max_length);
}

void SchemaWriter::name(std::size_t&, const std::vector<std::string>& names, const char* what) {
  schema_ = {{"type", "string"}, {"enum", names}};
  allowed_ = fmt::format("{}: one of {}", what, quoted_list(names));
}

void SchemaWriter::vector3(Vec3& value, NumberRange component) {
  const SchemaWriter item = described([&](Fields& f) { f.number(value.x(), component); });
  schema_ = {{"type", "array"}, {"items", item.schema_}, {"minItems", 3}, {"maxItems", 3}};
  allowed_ = "three numbers [x, y, z], each " + item.allowed_;
}

void SchemaWriter::pair(const char* allowed, Body first, Body second) {
  const Json items = {described(first).schema_, described(second).schema_};
  schema_ = {{"type", "array"}, {"items", items}, {"minItems", 2}, {"maxItems", 2}};
  allowed_ = allowed;
}

void SchemaWriter::entries(std::size_t length, ListSize size, FunctionRef<std::size_t>,
                           FunctionRef<Fields&, std::size_t> entry) {
  const SchemaWriter item = described([&](Fields& f) { entry(f, length); });
  schema_ = {{"type", "array"}, {"items", item.schema_}, {"minItems", size.min}, {"maxItems", size.max}};
  allowed_ = fmt::format("a list of {} ... {} entries, each {}", size.min, size.max, item.allowed_);
}

void SchemaWriter::any_of(Body first, const char* between, Body second) {
  const SchemaWriter a = described(first), b = described(second);
  schema_ = {{"anyOf", {a.schema_, b.schema_}}};
  allowed_ = a.allowed_ + between + b.allowed_;
}

void SchemaWriter::or_null(bool, FunctionRef<>, Body value) {
  const SchemaWriter inner = described(value);
  schema_ = {{"anyOf", {{{"type", "null"}}, inner.schema_}}};
  allowed_ = "null or " + inner.allowed_;
}

void SchemaWriter::number_or_object(bool, Body number, Body object) {
  any_of(number, ", or ", object);
}

void SchemaWriter::one_or_list(bool, Body one, Body list) {
  any_of(one, ", or ", list);
}

void SchemaWriter::alternatives(const char*, std::span<const char* const> names, Untyped untyped, std::size_t,
                                FunctionRef<Fields&, std::size_t> fields) {
  Json choices = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    SchemaWriter choice;
    choice.fields([&](Fields& f) {
      choice.schema_["properties"][kTypeField] = {{"const", names[i]}};
      if (untyped == Untyped::refused || i > 0) choice.schema_["required"].push_back(kTypeField);
      fields(f, i);
    });
    choices.push_back(std::move(choice.schema_));
  }
  schema_ = {{"oneOf", std::move(choices)}};
  allowed_ = fmt::format("an object whose \"{}\" is one of {}", kTypeField,
                         quoted_list(std::vector<std::string>(names.begin(), names.end())));
}

void SchemaWriter::fields(Body body) {
  schema_ = {
      {"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}, {"required", Json::array()}};
  body(*this);
  if (schema_["required"].empty()) schema_.erase("required");
  allowed_ = "an object with the fields " + quoted_list(names_);
}

void SchemaWriter::field(std::string_view name, const char* doc, Presence presence, Body value) {
  Json entry = described(value).schema_;
  entry["description"] = doc;
  if (presence == Presence::has_default) {
    Writer writer(Writer::Which::with_default);
    value(writer);
    entry["default"] = writer.json();
  }
  names_.emplace_back(name);
  schema_["properties"][names_.back()] = std::move(entry);
  if (presence == Presence::required) schema_["required"].push_back(names_.back());
}

void SchemaWriter::ignored(std::string_view name, const char* doc) {
  names_.emplace_back(name);
  schema_["properties"][names_.back()] = {{"description", doc}};
}

void SchemaWriter::exactly_one_of(const char* a, const char* b) {
  if (schema_.contains("oneOf")) throw std::logic_error("exactly_one_of twice in one object");
  schema_["oneOf"] = Json::array({Json{{"required", {a}}}, Json{{"required", {b}}}});
}

}  // namespace hapbench
