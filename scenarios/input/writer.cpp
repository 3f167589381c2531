#include "scenarios/input/writer.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace hapbench {
namespace {

/// Selects the fields to write. all: the fields that have a value. with_default: only fields that are required or
/// have a fixed default.
enum class Which { all, with_default };

/// Visitor that writes a value as JSON and calls a callback for each file that the value names.
class Writer final : public Fields {
 public:
  /// Writes the value that `value` describes. `on_file` may be null; otherwise it must outlive the writer. `at` is
  /// the JSON pointer of the value.
  Writer(Which which, Body value, const OnFile* on_file, std::string at = "")
      : which_(which), on_file_(on_file), at_(std::move(at)) {
    value(*this);
  }

  Json json() && { return std::move(json_); }

  void number(double& value, NumberRange) override { json_ = value; }
  void integer(std::int64_t& value, IntegerRange) override { json_ = value; }
  void boolean(bool& value) override { json_ = value; }
  void text(std::string& value, std::size_t) override { json_ = value; }
  void file(std::string& path, const FileContent& content) override {
    json_ = path;
    if (on_file_ != nullptr) (*on_file_)(at_, path, content);
  }
  void any_object(std::string& json) override { json_ = Json::parse(json); }
  void vector3(Vec3& value, NumberRange) override { json_ = {value.x(), value.y(), value.z()}; }
  void name(std::size_t& index, const std::vector<std::string>& names, const char* what) override {
    if (index >= names.size()) throw std::logic_error(std::string("a value without a name: ") + what);
    json_ = names[index];
  }
  void pair(const char*, double& first, NumberRange, double& second, NumberRange) override { json_ = {first, second}; }
  void entries(std::size_t length, ListSize, FunctionRef<std::size_t>,
               FunctionRef<Fields&, std::size_t> entry) override {
    json_ = Json::array();
    for (std::size_t i = 0; i < length; ++i)
      json_.push_back(written(std::to_string(i), [&entry, i](Fields& f) { entry(f, i); }));
  }
  void or_null(bool is_null, FunctionRef<>, Body value) override {
    if (!is_null) value(*this);
  }
  void plain_or_object(bool is_object, Body plain, Body object) override { (is_object ? object : plain)(*this); }
  void one_or_list(bool is_list, Body one, Body list) override { (is_list ? list : one)(*this); }
  void alternatives(const char*, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override {
    if (held >= types.size()) throw std::logic_error("a variant without a value");
    json_ = Json::object();
    if (untyped == Untyped::refused || held > 0) json_[kTypeField] = types[held].name;
    fields(*this, held);
  }
  void fields(Body body) override {
    json_ = Json::object();
    body(*this);
  }
  void field(std::string_view name, const char*, Presence presence, Body value) override {
    if (presence == Presence::omitted) return;
    if (presence == Presence::no_default && which_ == Which::with_default) return;
    json_[std::string(name)] = written(name, value);
  }

 private:
  /// Returns the JSON of the field or entry `name`.
  Json written(std::string_view name, Body value) const {
    return Writer(which_, value, on_file_, on_file_ != nullptr ? fmt::format("{}/{}", at_, name) : "").json();
  }

  Which which_;
  const OnFile* on_file_;
  std::string at_;  ///< JSON pointer of the value; empty if on_file_ is null
  Json json_;
};

}  // namespace

Json json_of(Fields::Body value, const OnFile& file) {
  return Writer(Which::all, value, file ? &file : nullptr).json();
}

Json default_of(Fields::Body value) {
  return Writer(Which::with_default, value, nullptr).json();
}

}  // namespace hapbench
