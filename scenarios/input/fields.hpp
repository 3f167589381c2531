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

/// The format of scenario files, described once, so that program, files, schema and documentation cannot disagree. A
/// function `describe(Fields&, T&)` for each struct names its fields with meaning, unit and range. Visitors use that to
/// read files (read_value), to write them and find the files that they name (json_of) and to explain them (guide_to).
namespace hapbench {

/// A parameter that is called and not kept.
template <class... Arguments>
using FunctionRef = const std::function<void(Arguments...)>&;

/// Bounds of an integer, included.
struct IntegerRange {
  std::int64_t min;
  std::int64_t max;
};

/// Fewest and most entries of a list.
struct ListSize {
  std::size_t min;
  std::size_t max;
};

/// Tells whether a field must be in a file, and what applies if it is not.
enum class Presence {
  required,
  has_default,  ///< the member's value in a default-constructed object
  no_default,   ///< no default holds for every scenario; the field's meaning says what applies
  left_out      ///< as no_default, and the object has no value to write
};

/// The meaning of an object without a "type", where types choose the fields.
enum class Untyped {
  refused,
  first  ///< one of the first type, which is written without
};

/// The field that chooses the alternative of an object.
inline constexpr const char* kTypeField = "type";

/// A value of the field "type", and what such an object is in a few words.
struct TypeName {
  const char* name;
  const char* summary;
};

/// The content of a file that a scenario names, and how it is read.
struct FileContent {
  enum class Kind { point_shell, mesh, stroke, trace, library };
  Kind kind;
  MeshSampling sampling = {};  ///< of a mesh
};

/// The field of an object that names a file. No other field names one, and no field of that name holds anything else.
inline constexpr const char* kFileField = "file";
/// Longest path of a file [characters].
inline constexpr std::size_t kLongestPath = 4096;

/// Visitor of one JSON value: of what kind it is, bound to the C++ object that holds it. Of an object it visits the
/// fields, each of which is a value of its own and has a visitor of its own.
class Fields {
 public:
  using Body = FunctionRef<Fields&>;

  virtual ~Fields() = default;

  // The kinds of values. A visitor is told one of these, once.
  virtual void number(double& value, NumberRange range) = 0;
  /// A JSON number such as 1e3 counts as an integer.
  virtual void integer(std::int64_t& value, IntegerRange range) = 0;
  virtual void boolean(bool& value) = 0;
  /// Any text up to `max_length` characters (code points).
  virtual void text(std::string& value, std::size_t max_length) = 0;
  /// The path of a file, relative to the scenario file.
  virtual void file(std::string& path, const FileContent&) { text(path, kLongestPath); }
  /// One of `names`, by its index; `what` says of what kind, for messages.
  virtual void name(std::size_t& index, const std::vector<std::string>& names, const char* what) = 0;
  /// Three numbers [x, y, z].
  virtual void vector3(Vec3& value, NumberRange component) = 0;
  /// A list of two numbers; `allowed` says which, for messages.
  virtual void pair(const char* allowed, double& first, NumberRange of_first, double& second,
                    NumberRange of_second) = 0;
  /// A list that has `length` entries and can be resized. The entry behind the last is an example, for the schema.
  virtual void entries(std::size_t length, ListSize size, FunctionRef<std::size_t> resize,
                       FunctionRef<Fields&, std::size_t> entry) = 0;
  /// null, or what `value` describes.
  virtual void or_null(bool is_null, FunctionRef<> set_null, Body value) = 0;
  /// A number or a name, or an object.
  virtual void plain_or_object(bool is_object, Body plain, Body object) = 0;
  /// Any object, as JSON text: the program hands it on and does not look into it.
  virtual void any_object(std::string& json) = 0;
  /// A single value, or a list.
  virtual void one_or_list(bool is_list, Body one, Body list) = 0;
  /// An object whose field "type" is one of `types` and chooses the other fields; `what` says of what kind. `held` is
  /// the index of the alternative to write. `fields` describes those of an alternative.
  virtual void alternatives(const char* what, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                            FunctionRef<Fields&, std::size_t> fields) = 0;
  /// An object. `body` is called with this visitor, perhaps more than once, and describes the object's fields.
  virtual void fields(Body body) = 0;
  /// A value that is described alike in many places: the schema has it once, as the definition of this name.
  virtual void shared(const char*, Body value) { value(*this); }

  // Inside `fields`: the object's fields. Names must live as long as the visit, as literals do.
  virtual void field(std::string_view name, const char* doc, Presence presence, Body value) = 0;
  /// A field that may hold anything and means nothing, such as "$schema".
  virtual void ignored(std::string_view /*name*/, const char* /*doc*/) {}
  /// Exactly one of two fields must be there. Called after both and at most once for an object.
  virtual void exactly_one_of(const char* /*a*/, const char* /*b*/) {}

  // Inside `fields`, for what a schema cannot say.
  /// True while fields are being read: what was described so far has its value.
  virtual bool reads() const { return false; }
  /// JSON pointer of the value that is being read.
  virtual std::string at() const { return {}; }
  /// Returns true if the file being read has that field; always false for writers.
  virtual bool given(std::string_view) const { return false; }

  // ---- The same for C++ types, by the primitives above. ----

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

  /// A value of an enumeration; `names` are those of all its values, which count from 0.
  template <class Enum>
  void choice(Enum& value, const std::vector<std::string>& names, const char* what) {
    auto index = static_cast<std::size_t>(value);
    name(index, names, what);
    if (reads()) value = static_cast<Enum>(index);
  }

  void choice(std::string& value, const std::vector<std::string>& names, const char* what) {
    auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), value) - names.begin());
    name(index, names, what);
    if (reads()) value = names[index];
  }

  /// `each(Fields&, T&)` describes an entry.
  template <class T, class Each>
  void list(std::vector<T>& values, ListSize size, Each each) {
    entries(
        values.size(), size, [&values](std::size_t length) { values.assign(length, T{}); },
        [&values, &each](Fields& f, std::size_t i) {
          T example{};
          each(f, i < values.size() ? values[i] : example);
        });
  }

  /// The types of a variant, named in the variant's order; `each(Fields&, T&)` describes the fields of one.
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
  /// The same where a function `describe` is visible for each type that has members.
  template <class... Ts>
  void variant(std::variant<Ts...>& value, const char* what, const TypeName (&types)[sizeof...(Ts)],
               Untyped untyped = Untyped::refused) {
    variant(value, what, types, untyped, [](Fields& f, auto& held) {
      if constexpr (!std::is_empty_v<std::decay_t<decltype(held)>>) describe(f, held);
    });
  }

  // ---- Fields of the kinds above: a name, the member, its range, and what it means. ----

  void number(std::string_view name, double& value, NumberRange range, const char* doc,
              Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) { f.number(value, range); });
  }
  /// null without a value, here and below; `each(Fields&, T&)` describes a value, at first a default-constructed one.
  template <class T, class Each>
  void nullable(std::string_view name, std::optional<T>& value, const char* doc, Each each,
                Presence presence = Presence::has_default) {
    field(name, doc, presence, [&](Fields& f) {
      f.or_null(
          !value, [&value] { value.reset(); }, [&](Fields& held) { describe_held(held, value, each); });
    });
  }
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
  /// The field kFileField, which is required. `content` as the object says it now.
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
  template <class T>
  void object(std::string_view name, std::optional<T>& value, const char* doc) {
    nullable(name, value, doc, [](Fields& f, T& inner) { f.object(inner); });
  }
  /// A value whose `describe` says of what kind it is.
  template <class T>
  void value(std::string_view name, T& value, const char* doc, Presence presence = Presence::has_default) {
    field(name, doc, presence, [&value](Fields& f) { describe(f, value); });
  }
  /// Fields of the same C++ object that lie in a JSON object of their own.
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
  /// A field that is in the file exactly when the optional has a value.
  template <class T, class Each>
  void if_any(std::string_view name, std::optional<T>& value, const char* doc, Each each) {
    field(name, doc, value ? Presence::no_default : Presence::left_out,
          [&](Fields& f) { describe_held(f, value, each); });
  }
  /// An object that is in the file exactly when the optional has a value.
  template <class T>
  void object_if_any(std::string_view name, std::optional<T>& value, const char* doc) {
    if_any(name, value, doc, [](Fields& f, T& inner) { f.object(inner); });
  }

 private:
  /// Describes the value, or without one a default-constructed one, which is kept when it has been read.
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
