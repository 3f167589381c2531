#include "scenarios/description/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapbench {

void refuse(const Json& json, const std::string& at, const std::string& allowed, const std::string& hint) {
  throw InputError(InputError::Kind::shape, at, fmt::format("got {}; allowed: {}{}", shown(json), allowed, hint));
}

namespace {

class NumberCodec final : public Codec<double> {
 public:
  explicit NumberCodec(NumberRange range) : range_(range) {}

  void read(const Json& json, const std::string& at, double& out) const override {
    if (!json.is_number()) refuse(json, at, allowed());
    const double value = json.get<double>();
    const bool above = range_.above_min ? value > range_.min : value >= range_.min;
    if (!above || !(value <= range_.max)) refuse(json, at, allowed());
    out = value;
  }
  Json write(const double& value) const override { return value; }
  Json schema() const override {
    return {
        {"type", "number"}, {range_.above_min ? "exclusiveMinimum" : "minimum", range_.min}, {"maximum", range_.max}};
  }
  std::string allowed() const override {
    const std::string unit = *range_.unit == '\0' ? "" : fmt::format(" [{}]", range_.unit);
    return fmt::format("a number {} {} and <= {}{}", range_.above_min ? ">" : ">=", range_.min, range_.max, unit);
  }

 private:
  NumberRange range_;
};

class IntegerCodec final : public Codec<std::int64_t> {
 public:
  IntegerCodec(std::int64_t min, std::int64_t max) : min_(min), max_(max) {}

  void read(const Json& json, const std::string& at, std::int64_t& out) const override {
    if (!json.is_number()) refuse(json, at, allowed());
    // Through double, which sees unsigned and 1e3 alike and is exact for every integer the ranges below allow.
    const double value = json.get<double>();
    const auto low = static_cast<double>(min_);
    const auto high = static_cast<double>(max_);
    if (!(value >= low && value <= high) || value != std::floor(value)) refuse(json, at, allowed());
    out = static_cast<std::int64_t>(value);
    // 2^53 + 1 would round to 2^53.
    if (json.is_number_integer() && json != Json(out)) refuse(json, at, allowed());
  }
  Json write(const std::int64_t& value) const override { return value; }
  Json schema() const override { return {{"type", "integer"}, {"minimum", min_}, {"maximum", max_}}; }
  std::string allowed() const override { return fmt::format("an integer {} ... {}", min_, max_); }

 private:
  std::int64_t min_, max_;
};

class BooleanCodec final : public Codec<bool> {
 public:
  void read(const Json& json, const std::string& at, bool& out) const override {
    if (!json.is_boolean()) refuse(json, at, allowed());
    out = json.get<bool>();
  }
  Json write(const bool& value) const override { return value; }
  Json schema() const override { return {{"type", "boolean"}}; }
  std::string allowed() const override { return "true or false"; }
};

class TextCodec final : public Codec<std::string> {
 public:
  explicit TextCodec(std::size_t max_length) : max_length_(max_length) {}

  void read(const Json& json, const std::string& at, std::string& out) const override {
    if (!json.is_string() || characters(json.get_ref<const std::string&>()) > max_length_) refuse(json, at, allowed());
    out = json.get<std::string>();
  }
  Json write(const std::string& value) const override { return value; }
  Json schema() const override { return {{"type", "string"}, {"maxLength", max_length_}}; }
  std::string allowed() const override { return fmt::format("a text of at most {} characters", max_length_); }

 private:
  /// Code points of a UTF-8 text, which is what a schema counts.
  static std::size_t characters(const std::string& text) {
    const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
    return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), continues));
  }

  std::size_t max_length_;
};

class NameCodec final : public Codec<std::string> {
 public:
  NameCodec(std::vector<std::string> names, std::string what) : names_(std::move(names)), what_(std::move(what)) {}

  void read(const Json& json, const std::string& at, std::string& out) const override {
    if (!json.is_string()) refuse(json, at, allowed());
    const auto& name = json.get_ref<const std::string&>();
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) {
      refuse(json, at, allowed(), nearest_name_hint(name, names_));
    }
    out = name;
  }
  Json write(const std::string& value) const override { return value; }
  Json schema() const override { return {{"type", "string"}, {"enum", names_}}; }
  std::string allowed() const override { return fmt::format("{}: one of {}", what_, quoted_list(names_)); }

 private:
  std::vector<std::string> names_;
  std::string what_;
};

class Vector3Codec final : public Codec<Vec3> {
 public:
  explicit Vector3Codec(NumberRange component) : component_(number(component)) {}

  void read(const Json& json, const std::string& at, Vec3& out) const override {
    if (!json.is_array() || json.size() != 3) refuse(json, at, allowed());
    for (std::size_t i = 0; i < 3; ++i) {
      component_->read(json[i], element(at, i), out[static_cast<Eigen::Index>(i)]);
    }
  }
  Json write(const Vec3& value) const override { return {value.x(), value.y(), value.z()}; }
  Json schema() const override {
    return {{"type", "array"}, {"items", component_->schema()}, {"minItems", 3}, {"maxItems", 3}};
  }
  std::string allowed() const override { return "three numbers [x, y, z], each " + component_->allowed(); }

 private:
  CodecPtr<double> component_;
};

}  // namespace

CodecPtr<double> number(NumberRange range) {
  return std::make_shared<NumberCodec>(range);
}
CodecPtr<std::int64_t> integer(std::int64_t min, std::int64_t max) {
  return std::make_shared<IntegerCodec>(min, max);
}
CodecPtr<bool> boolean() {
  return std::make_shared<BooleanCodec>();
}
CodecPtr<std::string> text(std::size_t max_length) {
  return std::make_shared<TextCodec>(max_length);
}
CodecPtr<std::string> name_of(std::vector<std::string> names, std::string what) {
  return std::make_shared<NameCodec>(std::move(names), std::move(what));
}
CodecPtr<Vec3> vector3(NumberRange component) {
  return std::make_shared<Vector3Codec>(component);
}

}  // namespace hapbench
