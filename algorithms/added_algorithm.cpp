#include "algorithms/added_algorithm.hpp"

#include <cmath>
#include <deque>
#include <set>
#include <stdexcept>

namespace hapbench {
namespace {

/// What `info` and `own_parameters` of an added algorithm point to.
struct Texts {
  std::deque<std::string> all;
  ModelInfo info = {};
  std::vector<ParameterInfo> parameters;
  std::vector<OwnParameter> own;

  const char* copy(const char* text) { return all.emplace_back(text).c_str(); }
  NumberRange copy(NumberRange range) {
    range.unit = copy(range.unit);
    return range;
  }
};

[[noreturn]] void refuse(const std::string& problem) {
  throw std::invalid_argument(problem);
}

/// A name as a field and as a word of a list on the command line.
bool is_name(const char* text) {
  if (text == nullptr) return false;
  const std::string_view name = text;
  constexpr std::size_t kLongest = 64;
  return !name.empty() && name.size() <= kLongest && name[0] >= 'a' && name[0] <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == name.npos;
}

void require_text(const char* text, const std::string& what) {
  if (text == nullptr || *text == '\0') refuse(what + " is missing");
}

constexpr const char* kNames = "allowed: letters, digits and \"_\", a small letter first, at most 64";

void check(const OwnParameter& p) {
  if (!is_name(p.name)) refuse(std::string("a parameter is called \"") + (p.name ? p.name : "") + "\"; " + kNames);
  const std::string which = "parameter \"" + std::string(p.name) + "\": ";
  require_text(p.range.unit, which + "its unit");
  require_text(p.meaning, which + "its meaning");
  const auto& [min, max, unit, above_min] = p.range;
  if (!(std::isfinite(min) && std::isfinite(max) && min < max))
    refuse(which + "a range needs two finite ends, the lower first");
  if (!(p.initial <= max && (above_min ? p.initial > min : p.initial >= min)))
    refuse(which + "its default is out of its range");
}

/// Throws std::invalid_argument.
void check(const AlgorithmEntry& entry) {
  const ModelInfo& info = *entry.info;
  if (!is_name(info.name))
    refuse(std::string("an algorithm is called \"") + (info.name ? info.name : "") + "\"; " + kNames);
  // What "--algorithms all" means.
  if (info.name == std::string_view("all")) refuse("an algorithm is called \"all\", which means all of them");
  for (const auto& [what, text] :
       {std::pair{"its summary", info.summary}, std::pair{"its formula", info.formula},
        std::pair{"its source", info.source}, std::pair{"its known failure", info.known_failure}}) {
    require_text(text, what);
  }
  std::set<std::string_view> seen;
  for (const OwnParameter& p : entry.own_parameters) {
    check(p);
    if (!seen.insert(p.name).second) refuse("parameter \"" + std::string(p.name) + "\" is there twice");
  }
}

}  // namespace

AlgorithmEntry checked_copy(AlgorithmEntry entry) {
  check(entry);
  auto texts = std::make_shared<Texts>();
  Texts& t = *texts;
  const ModelInfo& info = *entry.info;
  for (const auto& [parameter, meaning] : info.parameters)
    t.parameters.push_back({{t.copy(parameter.field), t.copy(parameter.range)}, t.copy(meaning)});
  for (const OwnParameter& p : entry.own_parameters)
    t.own.push_back({t.copy(p.name), t.copy(p.range), p.initial, t.copy(p.meaning)});
  t.info = {t.copy(info.name),   t.copy(info.summary),       t.copy(info.formula),
            t.copy(info.source), t.copy(info.known_failure), t.parameters};
  entry.info = &t.info;
  entry.own_parameters = t.own;
  entry.texts = std::move(texts);
  return entry;
}

}  // namespace hapbench
