#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "scenarios/format/fields.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/format/writer.hpp"

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

  void number(double& value, NumberRange range) override {
    const auto allowed = [&](Fields& f) { f.number(value, range); };
    if (!json_.is_number()) refuse(allowed);
    const double given = json_.get<double>();
    const bool above = range.above_min ? given > range.min : given >= range.min;
    if (!above || !(given <= range.max)) refuse(allowed);
    value = given;
  }

  void integer(std::int64_t& value, IntegerRange range) override {
    const auto allowed = [&](Fields& f) { f.integer(value, range); };
    if (!json_.is_number()) refuse(allowed);
    // Through double, which sees unsigned and 1e3 alike and is exact for every integer that a range allows.
    const double given = json_.get<double>();
    const auto min = static_cast<double>(range.min), max = static_cast<double>(range.max);
    if (!(given >= min && given <= max) || given != std::floor(given)) refuse(allowed);
    const auto whole = static_cast<std::int64_t>(given);
    // 2^53 + 1 would round to 2^53.
    if (json_.is_number_integer() && json_ != Json(whole)) refuse(allowed);
    value = whole;
  }

  void boolean(bool& value) override {
    if (!json_.is_boolean()) refuse([&](Fields& f) { f.boolean(value); });
    value = json_.get<bool>();
  }

  void text(std::string& value, std::size_t max_length) override {
    if (!json_.is_string() || characters_of(json_.get_ref<const std::string&>()) > max_length)
      refuse([&](Fields& f) { f.text(value, max_length); });
    value = json_.get<std::string>();
  }

  void name(std::size_t& index, const std::vector<std::string>& names, const char* what) override {
    const auto allowed = [&](Fields& f) { f.name(index, names, what); };
    if (!json_.is_string()) refuse(allowed);
    const auto& given = json_.get_ref<const std::string&>();
    const auto found = std::find(names.begin(), names.end(), given);
    if (found == names.end()) {
      const bool in_file_of_its_own = std::ranges::count(at_, '/') == 1;  // a device with its preset
      const std::string shown_by = in_file_of_its_own ? fmt::format("hapbench describe {}s", what) : described_by("");
      fail(fmt::format("got {}{}; allowed: {}{}: one of {}", shown(json_), nearest_name_hint(given, names), null_or(),
                       what, quoted_list(names, shown_by)));
    }
    index = static_cast<std::size_t>(found - names.begin());
  }

  void vector3(Vec3& value, NumberRange component) override {
    if (!json_.is_array() || json_.size() != 3) refuse([&](Fields& f) { f.vector3(value, component); });
    for (std::size_t i = 0; i < 3; ++i)
      Reader(json_[i], element(at_, i)).number(value[static_cast<Eigen::Index>(i)], component);
  }

  void pair(const char* allowed, double& first, NumberRange of_first, double& second, NumberRange of_second) override {
    if (!json_.is_array() || json_.size() != 2)
      refuse([&](Fields& f) { f.pair(allowed, first, of_first, second, of_second); });
    Reader(json_[0], element(at_, 0)).number(first, of_first);
    Reader(json_[1], element(at_, 1)).number(second, of_second);
  }

  void entries(std::size_t length, ListSize size, FunctionRef<std::size_t> resize,
               FunctionRef<Fields&, std::size_t> entry) override {
    if (!json_.is_array() || json_.size() < size.min || json_.size() > size.max)
      refuse([&](Fields& f) { f.entries(length, size, resize, entry); });
    resize(json_.size());
    for (std::size_t i = 0; i < json_.size(); ++i) {
      Reader reader(json_[i], element(at_, i));
      collect([&] { entry(reader, i); });
    }
    throw_errors();
  }

  void or_null(bool, FunctionRef<> set_null, Body value) override {
    if (json_.is_null()) return set_null();
    null_allowed_ = true;
    value(*this);
  }

  void plain_or_object(bool is_object, Body plain, Body object) override {
    if (json_.is_object()) return object(*this);
    if (json_.is_number() || guide_to(plain).schema.at("type") == json_.type_name()) return plain(*this);
    refuse([&](Fields& f) { f.plain_or_object(is_object, plain, object); });
  }

  void any_object(std::string& json) override {
    if (!json_.is_object()) refuse([&](Fields& f) { f.any_object(json); });
    json = json_.dump();
  }

  void one_or_list(bool, Body one, Body list) override { (json_.is_array() ? list : one)(*this); }

  void alternatives(const char* what, std::span<const TypeName> choices, Untyped untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override {
    if (!json_.is_object())
      refuse([&](Fields& f) { f.alternatives(what, choices, untyped, held, fields); }, text_of_file_hint(json_));
    const std::vector<std::string> types = names_of(choices, &TypeName::name);
    const auto type = json_.find(kTypeField);
    if (type == json_.end() && untyped == Untyped::refused)
      fail(fmt::format("missing field \"{}\"; allowed: {}: one of {}", kTypeField, what, quoted_list(types)));
    std::size_t index = 0;
    if (type != json_.end()) Reader(*type, member(at_, kTypeField)).name(index, types, what);
    read_fields([&](Fields& f) { fields(f, index); }, {kTypeField}, what);
  }

  void fields(Body body) override {
    if (!json_.is_object()) refuse([&](Fields& f) { f.fields(body); });
    read_fields(body, {}, "scenario");
  }

  void field(std::string_view name, const char*, Presence presence, Body value) override {
    if (names_ != nullptr) return names_->push_back(name);
    const auto entry = json_.find(name);
    if (entry != json_.end()) {
      Reader reader(*entry, member(at_, std::string(name)));
      return collect([&] { value(reader); });
    }
    // A misspelt name of this field has been reported already.
    if (presence != Presence::required || std::ranges::count(meant_, name) > 0) return;
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
  /// Refuses the value: "got VALUE; allowed: ...", in the words that the schema writer has for `what`.
  [[noreturn]] void refuse(Body what, const std::string& hint = "") const {
    fail(fmt::format("got {}; allowed: {}{}{}", shown(json_), null_or(), guide_to(what).allowed, hint));
  }
  const char* null_or() const { return null_allowed_ ? "null or " : ""; }
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
      meant_.push_back(nearest_name(entry.key(), allowed));
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
  std::string at_;  ///< JSON pointer of the value
  bool null_allowed_ = false;
  /// When not null, the body of an object is called only to collect the names of its fields.
  std::vector<std::string_view>* names_ = nullptr;
  std::vector<InputError> errors_;  ///< of the fields or entries that were read
  std::vector<std::string> meant_;  ///< valid names near to unknown fields
};

}  // namespace

void read_value(const Json& json, const std::string& at, Fields::Body value) {
  Reader reader(json, at);
  value(reader);
}

}  // namespace hapbench
