#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/description/codec.hpp"
#include "sim/core/types.hpp"

/// Codecs of values: numbers, names, vectors, lists, and null.
namespace hapbench {

/// Range of a number; bounds are included unless said otherwise. The unit is for people.
struct NumberRange {
  double min;
  double max;
  const char* unit = "";
  bool above_min = false;  ///< min itself is excluded
};

CodecPtr<double> number(NumberRange range);
/// min … max as integers; a value such as 1e3 counts as one.
CodecPtr<std::int64_t> integer(std::int64_t min, std::int64_t max);
/// The same for another integer type of the configuration.
template <class Integer>
CodecPtr<Integer> integer_as(std::int64_t min, std::int64_t max);
CodecPtr<bool> boolean();
/// Any text up to `max_length` characters (code points).
CodecPtr<std::string> text(std::size_t max_length);
/// One of `names`; `what` says of what kind, for messages.
CodecPtr<std::string> name_of(std::vector<std::string> names, std::string what);
/// A value chosen by its name; `what` says of what kind, for messages.
template <class T>
CodecPtr<T> choice(std::vector<std::pair<std::string, T>> values, std::string what);
/// Three numbers [x, y, z].
CodecPtr<Vec3> vector3(NumberRange component);

/// A list of at least `min_items` and at most `max_items` values.
template <class T>
CodecPtr<std::vector<T>> list_of(CodecPtr<T> item, std::size_t min_items, std::size_t max_items);

/// null for "off", or a value.
template <class T>
CodecPtr<std::optional<T>> nullable(CodecPtr<T> inner, T initial = {});

// ---- implementation of the templates ----

namespace detail {

template <class Integer>
class IntegerAs final : public Codec<Integer> {
 public:
  IntegerAs(std::int64_t min, std::int64_t max) : inner_(integer(min, max)) {}

  void read(const Json& json, const std::string& at, Integer& out) const override {
    std::int64_t value = 0;
    inner_->read(json, at, value);
    out = static_cast<Integer>(value);
  }
  Json write(const Integer& value) const override { return value; }
  Json schema() const override { return inner_->schema(); }
  std::string allowed() const override { return inner_->allowed(); }

 private:
  CodecPtr<std::int64_t> inner_;
};

template <class T>
class ChoiceCodec final : public Codec<T> {
 public:
  ChoiceCodec(std::vector<std::pair<std::string, T>> values, std::string what) : values_(std::move(values)) {
    std::vector<std::string> names;
    for (const auto& value : values_) names.push_back(value.first);
    name_ = name_of(std::move(names), std::move(what));
  }

  void read(const Json& json, const std::string& at, T& out) const override {
    std::string name;
    name_->read(json, at, name);
    for (const auto& value : values_) {
      if (value.first == name) out = value.second;
    }
  }
  Json write(const T& value) const override {
    for (const auto& choice : values_) {
      if (choice.second == value) return choice.first;
    }
    return nullptr;
  }
  Json schema() const override { return name_->schema(); }
  std::string allowed() const override { return name_->allowed(); }

 private:
  std::vector<std::pair<std::string, T>> values_;
  CodecPtr<std::string> name_;
};

template <class T>
class ListCodec final : public Codec<std::vector<T>> {
 public:
  ListCodec(CodecPtr<T> item, std::size_t min_items, std::size_t max_items)
      : item_(std::move(item)), min_(min_items), max_(max_items) {}

  void read(const Json& json, const std::string& at, std::vector<T>& out) const override {
    if (!json.is_array() || json.size() < min_ || json.size() > max_) refuse(json, at, allowed());
    out.clear();
    out.reserve(json.size());
    for (const Json& entry : json) {
      T value{};
      item_->read(entry, element(at, out.size()), value);
      out.push_back(std::move(value));
    }
  }
  Json write(const std::vector<T>& value) const override {
    Json json = Json::array();
    for (const T& entry : value) json.push_back(item_->write(entry));
    return json;
  }
  Json schema() const override {
    return {{"type", "array"}, {"items", item_->schema()}, {"minItems", min_}, {"maxItems", max_}};
  }
  std::string allowed() const override {
    return "a list of " + std::to_string(min_) + " ... " + std::to_string(max_) + " entries, each " + item_->allowed();
  }

 private:
  CodecPtr<T> item_;
  std::size_t min_, max_;
};

template <class T>
class NullableCodec final : public Codec<std::optional<T>> {
 public:
  NullableCodec(CodecPtr<T> inner, T initial) : inner_(std::move(inner)), initial_(std::move(initial)) {}

  void read(const Json& json, const std::string& at, std::optional<T>& out) const override {
    if (json.is_null()) {
      out.reset();
      return;
    }
    T value = initial_;
    try {
      inner_->read(json, at, value);
    } catch (const InputError& error) {
      throw with_null(error, at);
    }
    out = std::move(value);
  }
  Json write(const std::optional<T>& value) const override { return value ? inner_->write(*value) : Json(nullptr); }
  Json schema() const override { return {{"anyOf", {{{"type", "null"}}, inner_->schema()}}}; }
  std::string allowed() const override { return "null or " + inner_->allowed(); }

 private:
  /// The inner codec's objection to the value itself does not know that null is allowed too.
  InputError with_null(const InputError& error, const std::string& at) const {
    const std::string allowed_inside = "allowed: " + inner_->allowed();
    const std::size_t start = error.problem().find(allowed_inside);
    if (error.place() != at || start == std::string::npos) return error;
    std::string problem = error.problem();
    return {error.kind(), at, problem.replace(start, allowed_inside.size(), "allowed: " + allowed())};
  }

  CodecPtr<T> inner_;
  T initial_;
};

}  // namespace detail

template <class Integer>
CodecPtr<Integer> integer_as(std::int64_t min, std::int64_t max) {
  return std::make_shared<detail::IntegerAs<Integer>>(min, max);
}

template <class T>
CodecPtr<T> choice(std::vector<std::pair<std::string, T>> values, std::string what) {
  return std::make_shared<detail::ChoiceCodec<T>>(std::move(values), std::move(what));
}

template <class T>
CodecPtr<std::vector<T>> list_of(CodecPtr<T> item, std::size_t min_items, std::size_t max_items) {
  return std::make_shared<detail::ListCodec<T>>(std::move(item), min_items, max_items);
}

template <class T>
CodecPtr<std::optional<T>> nullable(CodecPtr<T> inner, T initial) {
  return std::make_shared<detail::NullableCodec<T>>(std::move(inner), std::move(initial));
}

}  // namespace hapbench
