#include "scenarios/input/json_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_file.hpp"

namespace hapbench {
namespace {

constexpr int kMaxNesting = 64;
constexpr std::size_t kMaxKeys = 10'000;

[[noreturn]] void refuse_syntax(const std::string& problem) {
  throw InputError(InputError::Kind::shape, "", "is not JSON: " + problem);
}

/// The number in the parser's message "… number overflow parsing '1e999'".
std::string number_in(const std::string& message) {
  constexpr std::size_t kLongest = 80;
  const std::size_t start = message.find('\'');
  const std::string number =
      start == std::string::npos ? "a number too large" : message.substr(start + 1, message.rfind('\'') - start - 1);
  return number.size() > kLongest ? number.substr(0, kLongest) + "..." : number;
}

/// Follows the parser's events to refuse what the parser accepts, such as duplicate keys, and to know the position.
class Guard {
 public:
  bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    switch (event) {
      case Event::object_start:
      case Event::array_start:
        if (depth >= kMaxNesting) refuse_here(fmt::format("nested too deeply; allowed: {} levels", kMaxNesting));
        levels_.push_back({event == Event::array_start, "", 0, {}});
        break;
      case Event::object_end:
      case Event::array_end:
        levels_.pop_back();
        next_element();
        break;
      case Event::key:
        enter_key(parsed.get_ref<const std::string&>());
        break;
      case Event::value:
        next_element();
        break;
    }
    return true;
  }

  /// JSON pointer of the current value; only its first levels if it is deep.
  std::string pointer() const {
    std::string at;
    for (std::size_t i = 0; i < levels_.size() && i < 8; ++i)
      at = levels_[i].is_array ? element(at, levels_[i].index) : member(at, levels_[i].key);
    return at;
  }

  [[noreturn]] void refuse_here(const std::string& problem) const {
    throw InputError(InputError::Kind::shape, pointer(), problem);
  }

 private:
  struct Level {
    bool is_array;
    std::string key;
    std::size_t index;
    std::set<std::string> seen;
  };

  void next_element() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().index;
  }

  void enter_key(const std::string& key) {
    Level& object = levels_.back();
    object.key = key;
    if (!object.seen.insert(key).second) refuse_here("the key stands twice in one object; allowed: once");
    if (object.seen.size() > kMaxKeys) refuse_here(fmt::format("more than {} keys in one object", kMaxKeys));
  }

  std::vector<Level> levels_;  ///< open objects and arrays
};

}  // namespace

Json parse_json(const std::string& text) {
  // The parser takes a zero byte for the end of the text.
  if (text.find('\0') != std::string::npos) refuse_syntax("has a zero byte; allowed: UTF-8");
  Guard guard;
  try {
    return Json::parse(
        text, [&guard](int depth, Json::parse_event_t event, Json& parsed) { return guard(depth, event, parsed); });
  } catch (const Json::parse_error& error) {
    // "[json.exception.parse_error.101] parse error at line 2, column 5: syntax error while ...; last read: '...'"
    const std::string said = error.what();
    const std::size_t start = said.find("] ") + 2;
    refuse_syntax(said.substr(start, said.find("; last read") - start));
  } catch (const Json::out_of_range& error) {
    guard.refuse_here(fmt::format("got {}; allowed: finite numbers", number_in(error.what())));
  }
}

Json read_json(const std::filesystem::path& file) {
  return parse_json(read_text_file(file, kLargestJsonFile));
}

std::string shown(const Json& json) {
  constexpr std::size_t kLongest = 80;
  // Printing all of a large value could take long.
  if ((json.is_array() || json.is_object()) && json.size() > 20)
    return fmt::format("{} of {} entries", json.is_array() ? "a list" : "an object", json.size());
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

std::string member(const std::string& at, const std::string& name) {
  std::string key = name.substr(0, 200);
  // Keep the message on one line.
  std::ranges::replace_if(
      key, [](unsigned char c) { return c < 0x20; }, '?');
  return at + (Json::json_pointer() / key).to_string();
}

std::string element(const std::string& at, std::size_t index) {
  return at + "/" + std::to_string(index);
}

}  // namespace hapbench
