#pragma once

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "scenarios/description/codec.hpp"

/// Codecs of objects: fixed fields, and objects whose "type" field chooses the rest.
namespace hapbench {

/// An object with named fields, each bound to a part of T by an accessor `[](T& t) -> U& { … }`. Unknown keys are
/// errors. Defaults are those of a default-constructed T.
template <class T>
class ObjectCodec final : public Codec<T> {
 public:
  /// A field that must be there.
  template <class Access, class U = std::remove_reference_t<std::invoke_result_t<Access, T&>>>
  ObjectCodec& required(std::string name, Access access, CodecPtr<U> codec, std::string doc) {
    return add(std::move(name), access, std::move(codec), std::move(doc), true);
  }
  /// A field with a default.
  template <class Access, class U = std::remove_reference_t<std::invoke_result_t<Access, T&>>>
  ObjectCodec& optional(std::string name, Access access, CodecPtr<U> codec, std::string doc) {
    return add(std::move(name), access, std::move(codec), std::move(doc), false);
  }
  /// A field bound to a std::optional<U> that stays empty when the field is absent: its default depends on other fields
  /// (said in `doc`) and is filled in later.
  template <class Access, class U = typename std::remove_reference_t<std::invoke_result_t<Access, T&>>::value_type>
  ObjectCodec& deferred(std::string name, Access access, CodecPtr<U> codec, std::string doc, U initial = {}) {
    Field field;
    field.name = std::move(name);
    field.doc = std::move(doc);
    field.allowed = codec->allowed();
    field.read = [access, codec, initial](const Json& json, const std::string& at, T& out) {
      U value = initial;
      codec->read(json, at, value);
      access(out) = std::move(value);
    };
    field.write = [access, codec](const T& value, const std::string& key, Json& json) {
      const auto& part = access(const_cast<T&>(value));
      if (part) json[key] = codec->write(*part);
    };
    field.schema = [codec] { return codec->schema(); };
    fields_.push_back(std::move(field));
    return *this;
  }
  /// A key that is accepted and ignored, such as "$schema".
  ObjectCodec& ignored(std::string name, std::string doc) {
    Field field;
    field.name = std::move(name);
    field.doc = std::move(doc);
    field.allowed = "anything";
    field.read = [](const Json&, const std::string&, T&) {};
    field.write = [](const T&, const std::string&, Json&) {};
    field.schema = [] { return Json::object(); };
    fields_.push_back(std::move(field));
    return *this;
  }
  /// Exactly one of two fields must be there; the schema says so too.
  ObjectCodec& exactly_one_of(std::string a, std::string b) {
    exclusive_.emplace_back(std::move(a), std::move(b));
    return *this;
  }
  /// What fields say together, beyond a schema: `check(value, at)` throws an InputError of kind relation.
  ObjectCodec& relation(std::function<void(const T&, const std::string&)> check) {
    relations_.push_back(std::move(check));
    return *this;
  }

  void read(const Json& json, const std::string& at, T& out) const override { read_fields(json, at, out, ""); }

  /// As `read`, with one key more allowed (the tag of a tagged object).
  void read_fields(const Json& json, const std::string& at, T& out, const std::string& tag) const {
    if (!json.is_object()) refuse(json, at, allowed());
    for (const auto& entry : json.items()) {
      const bool is_tag = !tag.empty() && entry.key() == tag;
      if (!is_tag && find(entry.key()) == nullptr) refuse_unknown(entry.key(), at, tag);
    }
    for (const Field& field : fields_) {
      const auto entry = json.find(field.name);
      if (entry != json.end()) {
        field.read(*entry, member(at, field.name), out);
      } else if (field.required) {
        throw InputError(InputError::Kind::shape, at,
                         "missing field \"" + field.name + "\"; allowed: " + field.allowed);
      }
    }
    check_exclusive(json, at);
    for (const auto& check : relations_) check(out, at);
  }

  Json write(const T& value) const override {
    Json json = Json::object();
    for (const Field& field : fields_) field.write(value, field.name, json);
    return json;
  }

  Json schema() const override {
    Json properties = Json::object();
    Json required = Json::array();
    for (const Field& field : fields_) {
      Json entry = field.schema();
      entry["description"] = field.doc;
      if (field.default_value) entry["default"] = field.default_value();
      properties[field.name] = std::move(entry);
      if (field.required) required.push_back(field.name);
    }
    Json json = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    if (!required.empty()) json["required"] = std::move(required);
    for (const auto& [a, b] : exclusive_) {
      json["oneOf"] = Json::array({Json{{"required", {a}}}, Json{{"required", {b}}}});
    }
    return json;
  }

  std::string allowed() const override { return "an object with the fields " + quoted_list(names()); }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Field& field : fields_) names.push_back(field.name);
    return names;
  }

 private:
  struct Field {
    std::string name;
    std::string doc;
    std::string allowed;
    bool required = false;
    std::function<void(const Json&, const std::string&, T&)> read;
    std::function<void(const T&, const std::string&, Json&)> write;
    std::function<Json()> schema;
    std::function<Json()> default_value;
  };

  template <class Access, class U>
  ObjectCodec& add(std::string name, Access access, CodecPtr<U> codec, std::string doc, bool required) {
    Field field;
    field.name = std::move(name);
    field.doc = std::move(doc);
    field.allowed = codec->allowed();
    field.required = required;
    field.read = [access, codec](const Json& json, const std::string& at, T& out) {
      codec->read(json, at, access(out));
    };
    field.write = [access, codec](const T& value, const std::string& key, Json& json) {
      json[key] = codec->write(access(const_cast<T&>(value)));
    };
    field.schema = [codec] { return codec->schema(); };
    if (!required) {
      field.default_value = [access, codec] {
        T defaults{};
        return codec->write(access(defaults));
      };
    }
    fields_.push_back(std::move(field));
    return *this;
  }

  const Field* find(const std::string& name) const {
    for (const Field& field : fields_) {
      if (field.name == name) return &field;
    }
    return nullptr;
  }

  [[noreturn]] void refuse_unknown(const std::string& key, const std::string& at, const std::string& tag) const {
    std::vector<std::string> valid = names();
    if (!tag.empty()) valid.insert(valid.begin(), tag);
    throw InputError(InputError::Kind::shape, member(at, key),
                     "unknown field; allowed here: " + quoted_list(valid) + nearest_name_hint(key, valid));
  }

  void check_exclusive(const Json& json, const std::string& at) const {
    for (const auto& [a, b] : exclusive_) {
      const bool has_a = json.contains(a), has_b = json.contains(b);
      if (has_a && has_b) {
        throw InputError(InputError::Kind::shape, at,
                         "got both \"" + a + "\" and \"" + b + "\", which contradict; allowed: exactly one of them");
      }
      if (!has_a && !has_b) {
        throw InputError(InputError::Kind::shape, at,
                         "missing field; allowed: exactly one of \"" + a + "\" and \"" + b + "\"");
      }
    }
  }

  std::vector<Field> fields_;
  std::vector<std::pair<std::string, std::string>> exclusive_;
  std::vector<std::function<void(const T&, const std::string&)>> relations_;
};

template <class T>
std::shared_ptr<ObjectCodec<T>> object() {
  return std::make_shared<ObjectCodec<T>>();
}

/// An object whose field "type" chooses one of the alternatives of a std::variant.
template <class Variant>
class TaggedCodec final : public Codec<Variant> {
 public:
  explicit TaggedCodec(std::string what) : what_(std::move(what)) {}

  template <class T>
  TaggedCodec& alternative(std::string name, std::shared_ptr<ObjectCodec<T>> codec, T initial = {}) {
    Alternative alternative;
    alternative.name = std::move(name);
    alternative.holds = [](const Variant& value) { return std::holds_alternative<T>(value); };
    alternative.read = [codec, initial](const Json& json, const std::string& at, Variant& out) {
      T value = initial;
      codec->read_fields(json, at, value, kTag);
      out = std::move(value);
    };
    alternative.write = [codec](const Variant& value) { return codec->write(std::get<T>(value)); };
    alternative.schema = [codec] { return codec->schema(); };
    alternatives_.push_back(std::move(alternative));
    return *this;
  }

  void read(const Json& json, const std::string& at, Variant& out) const override {
    if (!json.is_object()) refuse(json, at, allowed());
    const auto tag = json.find(kTag);
    if (tag == json.end()) {
      throw InputError(InputError::Kind::shape, at, "missing field \"type\"; allowed: " + allowed_tags());
    }
    if (!tag->is_string()) refuse(*tag, member(at, kTag), allowed_tags());
    const auto& name = tag->template get_ref<const std::string&>();
    for (const Alternative& alternative : alternatives_) {
      if (alternative.name == name) return alternative.read(json, at, out);
    }
    refuse(*tag, member(at, kTag), allowed_tags(), nearest_name_hint(name, names()));
  }

  Json write(const Variant& value) const override {
    for (const Alternative& alternative : alternatives_) {
      if (!alternative.holds(value)) continue;
      Json json = {{kTag, alternative.name}};
      json.update(alternative.write(value));
      return json;
    }
    return nullptr;
  }

  Json schema() const override {
    Json choices = Json::array();
    for (const Alternative& alternative : alternatives_) {
      Json choice = alternative.schema();
      Json properties = {{kTag, {{"const", alternative.name}}}};
      properties.update(choice["properties"]);
      choice["properties"] = std::move(properties);
      if (!choice.contains("required")) choice["required"] = Json::array();
      choice["required"].insert(choice["required"].begin(), kTag);
      choices.push_back(std::move(choice));
    }
    return {{"oneOf", std::move(choices)}};
  }

  std::string allowed() const override { return "an object whose \"type\" is " + allowed_tags(); }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Alternative& alternative : alternatives_) names.push_back(alternative.name);
    return names;
  }

 private:
  static constexpr const char* kTag = "type";
  struct Alternative {
    std::string name;
    std::function<bool(const Variant&)> holds;
    std::function<void(const Json&, const std::string&, Variant&)> read;
    std::function<Json(const Variant&)> write;
    std::function<Json()> schema;
  };

  std::string allowed_tags() const { return what_ + ": one of " + quoted_list(names()); }

  std::string what_;
  std::vector<Alternative> alternatives_;
};

template <class Variant>
std::shared_ptr<TaggedCodec<Variant>> tagged(std::string what) {
  return std::make_shared<TaggedCodec<Variant>>(std::move(what));
}

}  // namespace hapbench
