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

/// Hint for users who passed the name of a file instead of its content.
std::string text_of_file_hint(const Json& given) {
  if (!given.is_string() || !given.get_ref<const std::string&>().ends_with(".json")) return "";
  return fmt::format("; on a command line \"$(cat {})\" is what is in the file", given.get_ref<const std::string&>());
}

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
    // Through double, which sees unsigned and 1e3 alike and is exact for every integer that a range allows.
    const double given = json_.get<double>();
    const auto min = static_cast<double>(range.min), max = static_cast<double>(range.max);
    if (!(given >= min && given <= max) || given != std::floor(given)) refuse();
    const auto whole = static_cast<std::int64_t>(given);
    // 2^53 + 1 would round to 2^53.
    if (json_.is_number_integer() && json_ != Json(whole)) refuse();
    value = whole;
  }

  void boolean(bool& value) override {
    if (!json_.is_boolean()) refuse();
    value = json_.get<bool>();
  }

  void text(std::string& value, std::size_t max_length) override {
    if (!json_.is_string() || characters_of(json_.get_ref<const std::string&>()) > max_length) refuse();
    value = json_.get<std::string>();
  }

  void name(std::size_t& index, const std::vector<std::string>& names, const char* what) override {
    if (!json_.is_string()) refuse();
    const auto& given = json_.get_ref<const std::string&>();
    const auto found = std::find(names.begin(), names.end(), given);
    if (found == names.end()) {
      const bool in_file_of_its_own = std::ranges::count(at_, '/') == 1;  // a device with its preset
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
    const std::vector<std::string> types = names_of(choices, &TypeName::name);
    const auto type = json_.find(kTypeField);
    if (type == json_.end() && untyped == Untyped::refused)
      fail(fmt::format("missing field \"{}\"; allowed: {}: one of {}", kTypeField, what, quoted_list(types)));
    std::size_t index = 0;
    if (type != json_.end()) read_value(*type, member(at_, kTypeField), [&](Fields& f) { f.name(index, types, what); });
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
    // A misspelt name of this field has been reported already.
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
  /// Refuses the value: "got VALUE; allowed: ...", in the words that the schema writer has for it.
  [[noreturn]] void refuse(const std::string& hint = "") const {
    fail(fmt::format("got {}; allowed: {}{}", shown(json_), guide_to(*value_).allowed, hint));
  }
  void read_number(std::size_t i, double& value, NumberRange range) const {
    read_value(json_[i], element(at_, i), [&](Fields& f) { f.number(value, range); });
  }
  /// Calls `read` and keeps the error that it may throw for `throw_errors`, which throws all that were kept.
  void collect(FunctionRef<> read) {
    try {
      read();
    } catch (const InputError& error) {
      errors_.push_back(error);
      if (errors_.size() == kMostFaults) throw_errors();
    }
  }
  void throw_errors() const {
    if (!errors_.empty()) throw InputError::all(errors_);
  }

  /// `names` are the fields that `body` does not describe; `root` is what a whole file of them is.
  void read_fields(Body body, std::vector<std::string_view> names, std::string_view root) {
    names_ = &names;
    body(*this);
    names_ = nullptr;
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
    collect([&] { body(*this); });
    throw_errors();
  }

  /// The command that describes the object that is being read.
  std::string described_by(std::string_view root) const {
    std::string section;
    for (const std::string_view key : parts_of(at_, '/')) {
      if (whole_number(key)) break;  // entries are described with their list
      if (!key.empty()) section += fmt::format("{}{}", section.empty() ? "" : ".", key);
    }
    return fmt::format("hapbench describe {}", section.empty() ? root : section);
  }

  const Json& json_;
  std::string at_;                                       ///< JSON pointer of the value
  const std::function<void(Fields&)>* value_ = nullptr;  ///< describes it
  /// When not null, the body of an object is called only to collect the names of its fields.
  std::vector<std::string_view>* names_ = nullptr;
  std::vector<InputError> errors_;      ///< of the fields or entries that were read
  std::vector<std::string> suggested_;  ///< valid names near to unknown fields
};

}  // namespace

void read_value(const Json& json, const std::string& at, Fields::Body value) {
  Reader(json, at).read(value);
}

}  // namespace hapbench
