#include "scenarios/description/writer.hpp"

#include <stdexcept>

namespace hapbench {

Json Writer::written(Body value) const {
  Writer writer(which_);
  value(writer);
  return std::move(writer.json_);
}

void Writer::number(double& value, NumberRange) {
  json_ = value;
}

void Writer::integer(std::int64_t& value, IntegerRange) {
  json_ = value;
}

void Writer::boolean(bool& value) {
  json_ = value;
}

void Writer::text(std::string& value, std::size_t) {
  json_ = value;
}

void Writer::name(std::size_t& index, const std::vector<std::string>& names, const char* what) {
  if (index >= names.size()) throw std::logic_error(std::string("a value without a name: ") + what);
  json_ = names[index];
}

void Writer::vector3(Vec3& value, NumberRange) {
  json_ = {value.x(), value.y(), value.z()};
}

void Writer::pair(const char*, Body first, Body second) {
  json_ = Json::array({written(first), written(second)});
}

void Writer::entries(std::size_t length, ListSize, FunctionRef<std::size_t>, FunctionRef<Fields&, std::size_t> entry) {
  json_ = Json::array();
  for (std::size_t i = 0; i < length; ++i) {
    json_.push_back(written([&entry, i](Fields& f) { entry(f, i); }));
  }
}

void Writer::or_null(bool is_null, FunctionRef<>, Body value) {
  if (!is_null) value(*this);
}

void Writer::number_or_object(bool is_object, Body number, Body object) {
  (is_object ? object : number)(*this);
}

void Writer::one_or_list(bool is_list, Body one, Body list) {
  (is_list ? list : one)(*this);
}

void Writer::alternatives(const char*, std::span<const TypeName> types, Untyped untyped, std::size_t held,
                          FunctionRef<Fields&, std::size_t> fields) {
  if (held >= types.size()) throw std::logic_error("a variant without a value");
  json_ = Json::object();
  if (untyped == Untyped::refused || held > 0) json_[kTypeField] = types[held].name;
  fields(*this, held);
}

void Writer::fields(Body body) {
  json_ = Json::object();
  body(*this);
}

void Writer::field(std::string_view name, const char*, Presence presence, Body value) {
  if (presence == Presence::left_out) return;
  if (presence == Presence::no_default && which_ == Which::with_default) return;
  json_[std::string(name)] = written(value);
}

void Writer::ignored(std::string_view, const char*) {}

void Writer::exactly_one_of(const char*, const char*) {}

}  // namespace hapbench
