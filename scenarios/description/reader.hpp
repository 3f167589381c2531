#pragma once

#include "results/summary/summary.hpp"
#include "scenarios/description/fields.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Reads and checks a JSON value. Fields that the file does not have leave their members as they are. Throws
/// InputError, of kind shape for what the schema refuses too, that names the place, the value and what is allowed.
/// After a fault the remaining fields and entries are still read, so that one error reports the faults of all.
class Reader final : public Fields {
 public:
  /// Reads `json`, found at the JSON pointer `at`; both must outlive the reader. Warnings are added to `warnings`, if
  /// any.
  Reader(const Json& json, std::string at, std::vector<Warning>* warnings = nullptr)
      : json_(json), at_(std::move(at)), warnings_(warnings) {}

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
  void plain_or_object(bool is_object, Body plain, Body object) override;
  void any_object(std::string& json) override;
  void one_or_list(bool is_list, Body one, Body list) override;
  void alternatives(const char* what, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override;
  void fields(Body body) override;

  void field(std::string_view name, const char* doc, Presence presence, Body value) override;
  void ignored(std::string_view name, const char* doc) override;
  void exactly_one_of(const char* a, const char* b) override;

  bool reads() const override { return names_ == nullptr && errors_.empty(); }
  std::string at() const override;
  bool given(std::string_view name) const override;
  void warn(const Warning& warning) override;

 private:
  /// Reads a field or an entry of the value that `parent` reads; both must outlive this reader, as must the name. The
  /// JSON pointer is built lazily: only errors need it, and sweeps read scenarios by the million.
  Reader(const Json& json, const Reader& parent, std::string_view name) : json_(json), parent_(&parent), name_(name) {}
  Reader(const Json& json, const Reader& parent, std::size_t index)
      : json_(json), parent_(&parent), index_(index), is_entry_(true) {}

  /// Refuses the value: "got VALUE; allowed: ...", in the words that the schema writer has for `what`.
  [[noreturn]] void refuse(Body what, const std::string& hint = "") const;
  /// Calls `read` and keeps the error that it may throw.
  void collect(FunctionRef<> read);
  /// Keeps an error for `throw_errors`, which throws all that were kept.
  void keep(const InputError& error);
  void throw_errors() const;
  void read_fields(Body body, std::vector<std::string_view> names);

  const Json& json_;
  std::string at_;  ///< JSON pointer of the value, for a reader without a parent
  const Reader* parent_ = nullptr;
  std::string_view name_;
  std::size_t index_ = 0;
  bool is_entry_ = false;
  std::vector<Warning>* warnings_ = nullptr;
  bool null_allowed_ = false;
  /// When not null, the body of an object is called only to collect the names of its fields.
  std::vector<std::string_view>* names_ = nullptr;
  std::vector<InputError> errors_;  ///< of the fields or entries that were read
  std::vector<std::string> meant_;  ///< valid names near to unknown fields
};

}  // namespace hapbench
