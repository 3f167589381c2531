#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "scenarios/input/mesh_sampling.hpp"
#include "sim/core/types.hpp"

/// The format of scenario files. It is described once in code, so that program, files, schema and documentation
/// cannot disagree. Each struct T has a function `describe(Fields&, T&)` that lists its fields with meaning, unit
/// and range. A visitor is an object of a class that derives from Fields and is passed to `describe`. Three functions
/// use visitors:
///   - read_value() uses a reader, which reads a value from JSON,
///   - json_of() uses a writer, which writes a value as JSON and lists the files that the value names,
///   - guide_to() uses a visitor that builds the JSON Schema and the documentation.
namespace hapbench {

/// Type of a parameter that is itself a function. The callee may only call it, and must not store it.
template <class... Arguments>
using FunctionRef = const std::function<void(Arguments...)>&;

/// Inclusive bounds of an integer.
struct IntegerRange {
  std::int64_t min;
  std::int64_t max;
};

/// Minimum and maximum number of entries of a list.
struct ListSize {
  std::size_t min;
  std::size_t max;
};

/// States whether a field must be in a file, and which value applies if it is missing.
enum class Presence {
  required,
  has_default,  ///< optional; default: the member's value in a default-constructed object
  no_default,   ///< optional; the default depends on the scenario, and the field's documentation gives it
  omitted       ///< optional; has no value at present, so that writers omit the field
};

/// Treatment of an object without the field "type", if the type determines the object's other fields.
enum class Untyped {
  refused,  ///< an error
  first     ///< an object without the field has the first type of the list; writers omit the field for this type
};

/// Field that selects one alternative of a variant.
inline constexpr const char* kTypeField = "type";

/// A value of the field "type", with a short description of the objects of this type.
struct TypeName {
  const char* name;
  const char* summary;
};

/// Kind of content of a file that a scenario names, and the parameters for reading this file.
struct FileContent {
  enum class Kind { point_shell, mesh, stroke, trace, library };
  Kind kind;
  MeshSampling sampling = {};  ///< used for a mesh only
};

/// Name of every field that holds the path of a file. A field with this name never holds anything else.
inline constexpr const char* kFileField = "file";
/// Maximum length of the path of a file [characters].
inline constexpr std::size_t kMaxPathLength = 4096;

/// Visitor of one JSON value. A function `describe` calls the member function for the value's kind (number, text, list
/// …) and passes the C++ object that holds the value. For a JSON object, the visitor visits the fields, and the value
/// of each field has its own visitor.
class Fields {
 public:
  using Body = FunctionRef<Fields&>;

  virtual ~Fields() = default;

  // One function for each kind of value. A function `describe` calls exactly one of these functions, once.
  virtual void number(double& value, NumberRange range) = 0;
  /// An integer. A JSON number with an integer value, such as 1e3, is accepted.
  virtual void integer(std::int64_t& value, IntegerRange range) = 0;
  virtual void boolean(bool& value) = 0;
  /// A text of at most `max_length` characters (Unicode code points).
  virtual void text(std::string& value, std::size_t max_length) = 0;
  /// The path of a file, relative to the scenario file.
  virtual void file(std::string& path, const FileContent&) { text(path, kMaxPathLength); }
  /// One of `names`, given by its index in `names`. `what` is the kind of name for messages, such as "algorithm".
  virtual void name(std::size_t& index, const std::vector<std::string>& names, const char* what) = 0;
  /// Three numbers [x, y, z].
  virtual void vector3(Vec3& value, NumberRange component) = 0;
  /// A list of two numbers. `allowed` describes them in messages, such as "a pair [time in s, value]".
  virtual void pair(const char* allowed, double& first, NumberRange of_first, double& second,
                    NumberRange of_second) = 0;
  /// A list with `length` entries. Readers call `resize` with the number of entries in the file. `entry` describes
  /// the entry at an index. The index `length` stands for an example entry, from which the schema is made.
  virtual void entries(std::size_t length, ListSize size, FunctionRef<std::size_t> resize,
                       FunctionRef<Fields&, std::size_t> entry) = 0;
  /// A value that is either null or described by `value`.
  virtual void or_null(bool is_null, FunctionRef<> set_null, Body value) = 0;
  /// A value that is either an object or plain. A plain value is a number or a name.
  virtual void plain_or_object(bool is_object, Body plain, Body object) = 0;
  /// An arbitrary JSON object, kept as JSON text. The program passes it on without interpreting it.
  virtual void any_object(std::string& json) = 0;
  /// A value that is either a single value or a list.
  virtual void one_or_list(bool is_list, Body one, Body list) = 0;
  /// An object whose field "type" is one of `types` and determines the other fields. `what` is the kind of object
  /// for messages, such as "device". `held` is the index of the type that the C++ object has now. `fields`
  /// describes the fields of the type at an index.
  virtual void alternatives(const char* what, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                            FunctionRef<Fields&, std::size_t> fields) = 0;
  /// An object. The visitor calls `body` with itself, possibly more than once. `body` describes the object's
  /// fields.
  virtual void fields(Body body) = 0;
  /// A value that many fields share. The schema documents this value once, in a definition with the given name.
  virtual void shared(const char*, Body value) { value(*this); }

  // Functions for the fields of an object, which the body of `fields` calls. A name must outlive the visit; use string
  // literals.
  virtual void field(std::string_view name, const char* doc, Presence presence, Body value) = 0;
  /// A field whose value is ignored, such as "$schema".
  virtual void ignored(std::string_view /*name*/, const char* /*doc*/) {}
  /// Requires exactly one of two fields. Call it after both fields, at most once for an object.
  virtual void exactly_one_of(const char* /*a*/, const char* /*b*/) {}

  // Functions for checks that a schema cannot express. The body of `fields` calls them.
  /// Returns true if values are being read and no error has occurred in this object. Then all fields that were
  /// described before have their values.
  virtual bool reads() const { return false; }
  /// Returns the JSON pointer of the value that is being read; empty for writers.
  virtual std::string at() const { return {}; }
  /// Returns true if the object being read has the field `name`; always false for writers.
  virtual bool given(std::string_view) const { return false; }

  // ---- Values of C++ types, implemented with the functions above. ----

  template <class T>
  void object(T& value) {
    fields([&value](Fields& f) { describe(f, value); });
  }

  template <class Integer>
  void integer(Integer& value, IntegerRange range) {
    auto wide = static_cast<std::int64_t>(value);
    integer(wide, range);
    value = static_cast<Integer>(wide);
  }

  /// A value of an enumeration. `names[i]` is the name of the enumerator with the value i.
  template <class Enum>
  void choice(Enum& value, const std::vector<std::string>& names, const char* what) {
    auto index = static_cast<std::size_t>(value);
    name(index, names, what);
    if (reads()) value = static_cast<Enum>(index);
  }

  /// A text that must be one of `names`.
  void choice(std::string& value, const std::vector<std::string>& names, const char* what) {
    auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), value) - names.begin());
    name(index, names, what);
    if (reads()) value = names[index];
  }

  /// A list of values of type T. `each(Fields&, T&)` describes an entry.
  template <class T, class Each>
  void list(std::vector<T>& values, ListSize size, Each each) {
    entries(
        values.size(), size, [&values](std::size_t length) { values.assign(length, T{}); },
        [&values, &each](Fields& f, std::size_t i) {
          T example{};
          each(f, i < values.size() ? values[i] : example);
        });
  }

  /// A variant. `types` names the alternatives, in the variant's order. `each(Fields&, T&)` describes the fields of
  /// the alternative T.
  template <class... Ts, class Each>
  void variant(std::variant<Ts...>& value, const char* what, const TypeName (&types)[sizeof...(Ts)], Untyped untyped,
               Each each) {
    alternatives(what, types, untyped, value.index(), [&value, &each](Fields& f, std::size_t i) {
      if (f.reads()) emplace(value, i, std::index_sequence_for<Ts...>{});
      std::variant<Ts...> example;
      if (i != value.index()) emplace(example, i, std::index_sequence_for<Ts...>{});
      std::visit([&](auto& held) { each(f, held); }, i == value.index() ? value : example);
    });
  }
  /// A variant whose alternatives are described by functions `describe(Fields&, T&)`. An alternative T without members
  /// needs no such function.
  template <class... Ts>
  void variant(std::variant<Ts...>& value, const char* what, const TypeName (&types)[sizeof...(Ts)],
               Untyped untyped = Untyped::refused) {
    variant(value, what, types, untyped, [](Fields& f, auto& held) {
      if constexpr (!std::is_empty_v<std::decay_t<decltype(held)>>) describe(f, held);
    });
  }

  // ---- Fields: the name, the member that holds the value, its range, and its documentation. ----

  void number(std::string_view name, double& value, NumberRange range, const char* doc,
              Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.number(value, range); });
  }
  /// A field whose JSON value is null if the optional is empty. `each(Fields&, T&)` describes a value that is not null.
  /// If the optional is empty, `each` gets a default-constructed value; a reader then stores this value in the
  /// optional.
  template <class T, class Each>
  void nullable(std::string_view name, std::optional<T>& value, const char* doc, Each each,
                Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) {
      f.or_null(
          !value, [&value] { value.reset(); }, [&](Fields& held) { describe_held(held, value, each); });
    });
  }
  /// A number, or null if the optional is empty.
  void number(std::string_view name, std::optional<double>& value, NumberRange range, const char* doc,
              Presence presence = Presence::has_default) {
    nullable(
        name, value, doc, [range](Fields& f, double& inner) { f.number(inner, range); }, presence);
  }
  void boolean(std::string_view name, bool& value, const char* doc) {
    field(name, doc, Presence::has_default, [&](Fields& f) { f.boolean(value); });
  }
  void text(std::string_view name, std::string& value, std::size_t max_length, const char* doc,
            Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.text(value, max_length); });
  }
  /// The required field kFileField. `content` may depend on fields that were described before this field.
  void file(std::string& path, const FileContent& content, const char* doc) {
    field(kFileField, doc, Presence::required, [&](Fields& f) { f.file(path, content); });
  }
  void vector3(std::string_view name, Vec3& value, NumberRange component, const char* doc,
               Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.vector3(value, component); });
  }
  template <class Integer>
  void integer(std::string_view name, Integer& value, IntegerRange range, const char* doc,
               Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.integer(value, range); });
  }
  template <class Choice>
  void choice(std::string_view name, Choice& value, const std::vector<std::string>& names, const char* what,
              const char* doc, Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.choice(value, names, what); });
  }
  template <class T>
  void object(std::string_view name, T& value, const char* doc, Presence presence = Presence::has_default) {
    field(name, doc, presence, [&value](Fields& f) { f.object(value); });
  }
  /// An object, or null if the optional is empty.
  template <class T>
  void object(std::string_view name, std::optional<T>& value, const char* doc) {
    nullable(name, value, doc, [](Fields& f, T& inner) { f.object(inner); });
  }
  /// A value of any kind. `describe(Fields&, T&)` determines the kind.
  template <class T>
  void value(std::string_view name, T& value, const char* doc, Presence presence = Presence::has_default) {
    field(name, doc, presence, [&value](Fields& f) { describe(f, value); });
  }
  /// A JSON object that groups some fields of the current C++ object.
  void group(std::string_view name, const char* doc, Presence presence, Body fields) {
    field(name, doc, presence, [&](Fields& f) { f.fields(fields); });
  }
  template <class T, class Each>
  void list(std::string_view name, std::vector<T>& values, ListSize size, const char* doc, Each each,
            Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.list(values, size, each); });
  }
  template <class T>
  void objects(std::string_view name, std::vector<T>& values, ListSize size, const char* doc) {
    list(name, values, size, doc, [](Fields& f, T& value) { f.object(value); });
  }
  /// A field that is omitted from written files if the optional is empty. It is optional in files that are read.
  template <class T, class Each>
  void if_any(std::string_view name, std::optional<T>& value, const char* doc, Each each) {
    field(name, doc, value ? Presence::no_default : Presence::omitted,
          [&](Fields& f) { describe_held(f, value, each); });
  }
  /// An object that is omitted from written files if the optional is empty. It is optional in files that are read.
  template <class T>
  void object_if_any(std::string_view name, std::optional<T>& value, const char* doc) {
    if_any(name, value, doc, [](Fields& f, T& inner) { f.object(inner); });
  }

 private:
  /// Describes the value of the optional. If the optional is empty, describes a default-constructed value, and stores
  /// that value if it was read without error.
  template <class T, class Each>
  static void describe_held(Fields& f, std::optional<T>& value, Each& each) {
    if (value) return each(f, *value);
    T example{};
    each(f, example);
    if (f.reads()) value = std::move(example);
  }
  template <class Variant, std::size_t... I>
  static void emplace(Variant& value, std::size_t index, std::index_sequence<I...>) {
    ((index == I ? static_cast<void>(value.template emplace<I>()) : void()), ...);
  }
};

}  // namespace hapbench
