#include "scenarios/input/reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_schema.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

/// If `given` is a text that ends with ".json", returns a hint that the content of the file is needed instead of its
/// name. Otherwise returns an empty text.
std::string text_of_file_hint(const Json& given) {
  if (!given.is_string() || !given.get_ref<const std::string&>().ends_with(".json")) return "";
  return fmt::format("; on a command line \"$(cat {})\" is the content of the file",
                     given.get_ref<const std::string&>());
}

/// Visitor that reads a JSON value into the C++ object that a Fields::Body describes. Implements read_value.
class Reader final : public Fields {
 public:
  Reader(const Json& json, std::string at) : json_(json), at_(std::move(at)) {}

  void read(Body value) {
    value_ = &value;
    value(*this);
  }

  void number(double& value, NumberRange range) override {
    if (!json_.is_number()) refuse();
    const double given = json_.get<double>();
    const bool above = range.above_min ? given > range.min : given >= range.min;
    if (!above || !(given <= range.max)) refuse();
    value = given;
  }

  void integer(std::int64_t& value, IntegerRange range) override {
    if (!json_.is_number()) refuse();
    // Convert to double, so that 1000 and 1e3 are read alike. The conversion is exact for all integers in the allowed
    // ranges.
    const double given = json_.get<double>();
    const auto min = static_cast<double>(range.min), max = static_cast<double>(range.max);
    if (!(given >= min && given <= max) || given != std::floor(given)) refuse();
    const auto whole = static_cast<std::int64_t>(given);
    // Reject integers that a double cannot represent, such as 2^53 + 1, which the conversion rounds to 2^53.
    if (json_.is_number_integer() && json_ != Json(whole)) refuse();
    value = whole;
  }

  void boolean(bool& value) override {
    if (!json_.is_boolean()) refuse();
    value = json_.get<bool>();
  }

  void text(std::string& value, std::size_t max_length) override {
    if (!json_.is_string() || count_characters(json_.get_ref<const std::string&>()) > max_length) refuse();
    value = json_.get<std::string>();
  }

  void name(std::size_t& index, const std::vector<std::string>& names, const char* what) override {
    if (!json_.is_string()) refuse();
    const auto& given = json_.get_ref<const std::string&>();
    const auto found = std::find(names.begin(), names.end(), given);
    if (found == names.end()) {
      const bool in_file_of_its_own =
          std::ranges::count(at_, '/') == 1;  // top-level field, such as /preset of a device file
      const std::string shown_by = in_file_of_its_own ? fmt::format("hapbench describe {}s", what) : described_by("");
      fail(fmt::format("got {}{}; allowed: {}: one of {}", shown(json_), nearest_name_hint(given, names), what,
                       quoted_list(names, shown_by)));
    }
    index = static_cast<std::size_t>(found - names.begin());
  }

  void vector3(Vec3& value, NumberRange component) override {
    if (!json_.is_array() || json_.size() != 3) refuse();
    for (std::size_t i = 0; i < 3; ++i) read_number(i, value[static_cast<Eigen::Index>(i)], component);
  }

  void pair(const char*, double& first, NumberRange of_first, double& second, NumberRange of_second) override {
    if (!json_.is_array() || json_.size() != 2) refuse();
    read_number(0, first, of_first);
    read_number(1, second, of_second);
  }

  void entries(std::size_t, ListSize size, FunctionRef<std::size_t> resize,
               FunctionRef<Fields&, std::size_t> entry) override {
    if (!json_.is_array() || json_.size() < size.min || json_.size() > size.max) refuse();
    resize(json_.size());
    for (std::size_t i = 0; i < json_.size(); ++i)
      collect([&] { read_value(json_[i], element(at_, i), [&](Fields& f) { entry(f, i); }); });
    throw_errors();
  }

  void or_null(bool, FunctionRef<> set_null, Body value) override { json_.is_null() ? set_null() : value(*this); }

  void plain_or_object(bool, Body plain, Body object) override {
    if (json_.is_object()) return read(object);
    if (json_.is_number() || guide_to(plain).schema.at("type") == json_.type_name()) return read(plain);
    refuse();
  }

  void any_object(std::string& json) override {
    if (!json_.is_object()) refuse();
    json = json_.dump();
  }

  void one_or_list(bool, Body one, Body list) override { read(json_.is_array() ? list : one); }

  void alternatives(const char* what, std::span<const TypeName> choices, Untyped untyped, std::size_t,
                    FunctionRef<Fields&, std::size_t> fields) override {
    if (!json_.is_object()) refuse(text_of_file_hint(json_));
    // Find the type.
    const std::vector<std::string> types = names_of(choices, &TypeName::name);
    const auto type = json_.find(kTypeField);
    if (type == json_.end() && untyped == Untyped::refused)
      fail(fmt::format("missing field \"{}\"; allowed: {}: one of {}", kTypeField, what, quoted_list(types)));
    std::size_t index = 0;
    if (type != json_.end()) read_value(*type, member(at_, kTypeField), [&](Fields& f) { f.name(index, types, what); });
    // Read the fields of the type with this index.
    read_fields([&](Fields& f) { fields(f, index); }, {kTypeField}, what);
  }

  void fields(Body body) override {
    if (!json_.is_object()) refuse();
    read_fields(body, {}, "scenario");
  }

  void field(std::string_view name, const char*, Presence presence, Body value) override {
    if (names_ != nullptr) return names_->push_back(name);
    const auto entry = json_.find(name);
    if (entry != json_.end()) return collect([&] { read_value(*entry, member(at_, std::string(name)), value); });
    // Do not report a missing field if its name was already suggested as a correction for an unknown field.
    if (presence != Presence::required || std::ranges::count(suggested_, name) > 0) return;
    collect([&] { fail(fmt::format("missing field \"{}\"; allowed: {}", name, guide_to(value).allowed)); });
  }

  void ignored(std::string_view name, const char*) override {
    if (names_ != nullptr) names_->emplace_back(name);
  }

  void exactly_one_of(const char* a, const char* b) override {
    if (names_ != nullptr) return;
    const bool has_a = json_.contains(a), has_b = json_.contains(b);
    if (has_a != has_b) return;
    const char* problem = has_a ? "got both \"{}\" and \"{}\", which contradict; allowed: exactly one of them"
                                : "missing field; allowed: exactly one of \"{}\" and \"{}\"";
    fail(fmt::format(fmt::runtime(problem), a, b));
  }

  bool reads() const override { return names_ == nullptr && errors_.empty(); }
  std::string at() const override { return at_; }
  bool given(std::string_view name) const override { return names_ == nullptr && json_.contains(name); }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw InputError(InputError::Kind::shape, at_, problem); }
  /// Throws InputError "got VALUE; allowed: ...". The allowed values are described by guide_to.
  [[noreturn]] void refuse(const std::string& hint = "") const {
    fail(fmt::format("got {}; allowed: {}{}", shown(json_), guide_to(*value_).allowed, hint));
  }
  /// Reads element `i` of the list.
  void read_number(std::size_t i, double& value, NumberRange range) const {
    read_value(json_[i], element(at_, i), [&](Fields& f) { f.number(value, range); });
  }
  /// Calls `read`. If `read` throws an InputError, stores the error for throw_errors(). Once kMaxFaults errors are
  /// stored, calls throw_errors().
  void collect(FunctionRef<> read) {
    try {
      read();
    } catch (const InputError& error) {
      errors_.push_back(error);
      if (errors_.size() == kMaxFaults) throw_errors();
    }
  }
  void throw_errors() const {
    if (!errors_.empty()) throw InputError::all(errors_);
  }

  /// Reads the fields of an object. `names` are allowed fields that `body` does not describe. `root`: if the object
  /// is the whole file, the name by which "hapbench describe" explains it.
  void read_fields(Body body, std::vector<std::string_view> names, std::string_view root) {
    // Collect the names of the allowed fields.
    names_ = &names;
    body(*this);
    names_ = nullptr;
    // Report unknown fields.
    for (const auto& entry : json_.items()) {
      if (std::ranges::count(names, entry.key()) > 0) continue;
      const std::vector<std::string> allowed(names.begin(), names.end());
      const std::string hint = nearest_name_hint(entry.key(), allowed);
      collect([&] {
        throw InputError(
            InputError::Kind::shape, member(at_, entry.key()),
            fmt::format("unknown field{}; allowed here: {}", hint, quoted_list(allowed, described_by(root))));
      });
      suggested_.push_back(nearest_name(entry.key(), allowed));
    }
    // Read the fields.
    collect([&] { body(*this); });
    throw_errors();
  }

  /// Returns the command that documents the object that is being read.
  std::string described_by(std::string_view root) const {
    std::string section;
    for (const std::string_view key : parts_of(at_, '/')) {
      if (whole_number(key)) break;  // the documentation of a list includes its entries
      if (!key.empty()) section += fmt::format("{}{}", section.empty() ? "" : ".", key);
    }
    return fmt::format("hapbench describe {}", section.empty() ? root : section);
  }

  const Json& json_;
  std::string at_;                                       ///< JSON pointer of the value
  const std::function<void(Fields&)>* value_ = nullptr;  ///< description of the value; null before read()
  /// If not null, field() only adds the field's name to this list and reads nothing.
  std::vector<std::string_view>* names_ = nullptr;
  std::vector<InputError> errors_;      ///< errors of the fields or entries read so far
  std::vector<std::string> suggested_;  ///< valid names that were suggested for unknown fields
};

}  // namespace

void read_value(const Json& json, const std::string& at, Fields::Body value) {
  Reader(json, at).read(value);
}

}  // namespace hapbench
