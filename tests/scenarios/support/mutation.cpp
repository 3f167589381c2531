#include "tests/scenarios/support/mutation.hpp"

#include <algorithm>
#include <cctype>

namespace hapbench::test {
namespace {

using Pointer = Json::json_pointer;

void collect(const Json& json, const std::string& at, std::vector<std::string>& pointers) {
  pointers.push_back(at);
  if (json.is_object()) {
    for (const auto& entry : json.items()) collect(entry.value(), (Pointer(at) / entry.key()).to_string(), pointers);
  } else if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) collect(json[i], (Pointer(at) / i).to_string(), pointers);
  }
}

template <class T>
const T& any_of(const std::vector<T>& choices, Random& random) {
  return choices[random.below(choices.size())];
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& entry : object.items()) keys.push_back(entry.key());
  return keys;
}

std::string misspelt(std::string word, Random& random) {
  // Changing one byte of a multi-byte character would make the text invalid UTF-8, which every parser rejects.
  if (std::any_of(word.begin(), word.end(), [](char c) { return static_cast<unsigned char>(c) > 0x7f; }))
    return word + "x";
  const std::size_t i = word.empty() ? 0 : random.below(word.size());
  switch (word.empty() ? 1 : random.below(4)) {
    case 0:
      word.erase(i, 1);
      break;
    case 1:
      word.insert(i, 1, static_cast<char>('a' + random.below(26)));
      break;
    case 2:
      // Switch the case of a letter. For other characters, this could produce a control character, which
      // messages do not show literally.
      word[i] = std::isalpha(static_cast<unsigned char>(word[i])) != 0 ? static_cast<char>(word[i] ^ 0x20) : '_';
      break;
    default:
      std::swap(word[i], word[(i + 1) % word.size()]);
  }
  return word;
}

/// Values that are invalid for most fields, and some that are valid for a few fields. 2^53 + 1 is not included,
/// because valijson compares it as the double 2^53.
const std::vector<Json>& odd_values() {
  static const std::vector<Json> values = [] {
    std::vector<Json> some = Json::parse(R"([
      null, true, false, 0, 1, 2, -1, 100000, 100001, 0.5, 2.5, 1e3, 5.0, -0.0, 1e-300, 1e300, -1e300, 1e9, 1e12,
      9007199254740992, 9007199254740994, 18446744073709551615, -9223372036854775808,
      "", "5", "null", "mean", "free", "diverges", "leaves_hole", "linear", "round",
      [], {}, [0, 0, 1], [1, 2], ["leaves_hole"], ["diverges", "completes"], [[0, 1]],
      {"type": "sine", "mean": 0, "amplitude": 1, "period_s": 1}, {"type": "ramp", "start": 0, "rate_per_s": 1},
      {"type": "plane"}, {"min": 0}, {"threshold": 0.9}])")
                                 .get<std::vector<Json>>();
    for (const std::size_t length : {199u, 201u, 10'001u}) some.emplace_back(std::string(length, 'x'));
    some.emplace_back(std::string(199, 'x') + "\xc3\xa4");
    return some;
  }();
  return values;
}

/// Returns the object with the key `key` renamed to `name`, at the same position.
Json with_key_renamed(const Json& object, const std::string& key, const std::string& name) {
  Json renamed = Json::object();
  for (const auto& entry : object.items()) {
    const std::string& now = entry.key() == key ? name : entry.key();
    if (!renamed.contains(now)) renamed[now] = entry.value();
  }
  return renamed;
}

std::string change_object(Json& object, const Json& document, Random& random) {
  const std::vector<std::string> keys = keys_of(object);
  const std::string key = keys.empty() ? "" : any_of(keys, random);
  switch (keys.empty() ? 0 : random.below(4)) {
    case 0: {  // a name from another part of the document, or a name that is never valid
      const std::string path = any_of(pointers_in(document), random);
      const std::string name = path.empty() || random.below(4) == 0
                                   ? any_of<std::string>({"", "type", "x", "a/b~c"}, random)
                                   : Pointer(path).back();
      object[name] = any_of(odd_values(), random);
      return "adds \"" + name + "\"";
    }
    case 1:
    case 2:
      object.erase(key);
      return "deletes \"" + key + "\"";
    default: {
      const std::string name = misspelt(key, random);
      object = with_key_renamed(object, key, name);
      return "renames \"" + key + "\" to \"" + name + "\"";
    }
  }
}

std::string change_array(Json& array, Random& random) {
  switch (array.empty() ? 2 : random.below(4)) {
    case 0:
      array.erase(random.below(array.size()));
      return "deletes an entry";
    case 1:
      array.push_back(array[random.below(array.size())]);
      return "repeats an entry";
    case 2:
      array.push_back(any_of(odd_values(), random));
      return "appends a value";
    default:
      array = Json::array();
      return "empties the list";
  }
}

std::string change_number(Json& number, Random& random) {
  const double value = number.get<double>();
  const double factors[] = {-1.0, 0.0, 1e-9, 0.1, 1.5, 10.0, 1e6, 1e15, 1e200};
  switch (random.below(4)) {
    case 0:
      number = number.dump();
      return "a number as text";
    case 1:
      number = value + 0.5;
      return "half more";
    case 2:
      number = Json::array({value});
      return "a number as list";
    default:
      number = value * factors[random.below(std::size(factors))];
      return "another size";
  }
}

}  // namespace

std::vector<std::string> pointers_in(const Json& document) {
  std::vector<std::string> pointers;
  collect(document, "", pointers);
  return pointers;
}

Mutation mutated(const Json& document, Random& random) {
  Mutation mutation{document, ""};
  const std::vector<std::string> pointers = pointers_in(document);
  const std::string at = any_of(pointers, random);
  Json& value = mutation.document[Pointer(at)];
  std::string change;
  const std::uint64_t kind = random.below(6);
  if (kind == 0) {
    value = any_of(odd_values(), random);
    change = "an odd value";
  } else if (kind == 1) {
    value = document[Pointer(any_of(pointers, random))];
    change = "another part of the document";
  } else if (kind == 2) {
    value = random.below(2) == 0 ? Json::array({value}) : Json::object({{"type", value}});
    change = "wrapped";
  } else if (value.is_object()) {
    change = change_object(value, document, random);
  } else if (value.is_array()) {
    change = change_array(value, random);
  } else if (value.is_number()) {
    change = change_number(value, random);
  } else if (value.is_string()) {
    value = misspelt(value.get<std::string>(), random);
    change = "misspelt";
  } else {
    value = any_of(odd_values(), random);
    change = "an odd value";
  }
  mutation.change = "at \"" + at + "\": " + change;
  return mutation;
}

std::string mutated_text(std::string text, Random& random) {
  // Bytes that have a meaning for the parsers find more errors than random bytes.
  static const std::string kSyntax = "{}[]\",:.-+eE0123456789 \n\r\t\\/\0\x80\xff\xc3\xed";
  const std::uint64_t changes = 1 + random.below(4);
  for (std::uint64_t c = 0; c < changes; ++c) {
    const std::size_t i = text.empty() ? 0 : random.below(text.size());
    const std::size_t length = std::min<std::size_t>(1 + random.below(random.below(8) == 0 ? 200 : 4), text.size() - i);
    switch (random.below(6)) {
      case 0:
        text.erase(i, length);
        break;
      case 1:
        text.insert(i, text.substr(i, length));
        break;
      case 2:
        text.insert(i, 1, kSyntax[random.below(kSyntax.size())]);
        break;
      case 3:
        text.insert(i, text.substr(random.below(text.size() + 1), length));
        break;
      case 4:
        text.resize(i);
        break;
      default:
        if (!text.empty())
          text[i] = random.below(2) == 0 ? kSyntax[random.below(kSyntax.size())]
                                         : static_cast<char>(text[i] ^ (1 << random.below(8)));
    }
  }
  return text;
}

}  // namespace hapbench::test
