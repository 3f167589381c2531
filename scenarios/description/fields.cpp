#include "scenarios/description/fields.hpp"

#include <algorithm>

namespace hapbench {

void Fields::number(std::string_view name, double& value, NumberRange range, const char* doc, Presence presence) {
  field(name, doc, presence, [&](Fields& f) { f.number(value, range); });
}

void Fields::number(std::string_view name, std::optional<double>& value, NumberRange range, const char* doc,
                    Presence presence) {
  field(name, doc, presence,
        [&](Fields& f) { f.nullable(value, [range](Fields& n, double& inner) { n.number(inner, range); }); });
}

void Fields::boolean(std::string_view name, bool& value, const char* doc) {
  field(name, doc, Presence::has_default, [&](Fields& f) { f.boolean(value); });
}

void Fields::text(std::string_view name, std::string& value, std::size_t max_length, const char* doc,
                  Presence presence) {
  field(name, doc, presence, [&](Fields& f) { f.text(value, max_length); });
}

void Fields::file(std::string& path, const FileContent&) {
  text(path, kLongestPath);
}

void Fields::file(std::string& path, const FileContent& content, const char* doc) {
  field(kFileField, doc, Presence::required, [&](Fields& f) { f.file(path, content); });
}

void Fields::vector3(std::string_view name, Vec3& value, NumberRange component, const char* doc, Presence presence) {
  field(name, doc, presence, [&](Fields& f) { f.vector3(value, component); });
}

void Fields::name(std::string_view name, std::string& value, const std::vector<std::string>& names, const char* what,
                  const char* doc, Presence presence) {
  field(name, doc, presence, [&](Fields& f) {
    auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), value) - names.begin());
    f.name(index, names, what);
    if (f.reads()) value = names[index];
  });
}

void Fields::group(std::string_view name, const char* doc, Body fields, Presence presence) {
  field(name, doc, presence, [&](Fields& f) { f.fields(fields); });
}

}  // namespace hapbench
