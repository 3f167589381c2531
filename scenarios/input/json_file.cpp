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

constexpr int kMaxNesting = 64;           ///< levels of objects and lists; bounds the recursion
constexpr std::size_t kMaxKeys = 10'000;  ///< maximum number of keys of one object

[[noreturn]] void refuse_syntax(const std::string& problem) {
  throw InputError(InputError::Kind::shape, "", "is not JSON: " + problem);
}

/// Returns the number in the parser's message "… number overflow parsing '1e999'", truncated if it is long.
std::string number_in(const std::string& message) {
  constexpr std::size_t kLongest = 80;
  const std::size_t start = message.find('\'');
  const std::string number =
      start == std::string::npos ? "a number too large" : message.substr(start + 1, message.rfind('\'') - start - 1);
  return number.size() > kLongest ? number.substr(0, kLongest) + "..." : number;
}

/// Callback for the parser's events. Rejects input that the parser accepts, such as duplicate keys, and tracks
/// the JSON pointer of the current value.
class Guard {
 public:
  /// Handles one event of the parser. Returns true, so that the parser keeps the value. Throws InputError.
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

  /// Returns the JSON pointer of the current value, truncated to its first 8 levels.
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
  /// An object or array that is being parsed.
  struct Level {
    bool is_array;
    std::string key;             ///< current key of an object
    std::size_t index;           ///< current index of an array
    std::set<std::string> seen;  ///< keys of an object so far
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

  std::vector<Level> levels_;  ///< objects and arrays around the current value, outermost first
};

}  // namespace

Json parse_json(const std::string& text) {
  // The parser would treat a zero byte as the end of the text.
  if (text.find('\0') != std::string::npos) refuse_syntax("has a zero byte; allowed: UTF-8");
  Guard guard;
  try {
    return Json::parse(
        text, [&guard](int depth, Json::parse_event_t event, Json& parsed) { return guard(depth, event, parsed); });
  } catch (const Json::parse_error& error) {
    // Take the description out of a message such as
    // "[json.exception.parse_error.101] parse error at line 2, column 5: syntax error while ...; last read: '...'"
    const std::string message = error.what();
    const std::size_t start = message.find("] ") + 2;
    refuse_syntax(message.substr(start, message.find("; last read") - start));
  } catch (const Json::out_of_range& error) {
    guard.refuse_here(fmt::format("got {}; allowed: finite numbers", number_in(error.what())));
  }
}

Json read_json(const std::filesystem::path& file) {
  return parse_json(read_text_file(file, kMaxJsonFileBytes));
}

std::string shown(const Json& json) {
  constexpr std::size_t kLongest = 80;
  // Formatting a large value only to truncate it would be slow.
  if ((json.is_array() || json.is_object()) && json.size() > 20)
    return fmt::format("{} of {} entries", json.is_array() ? "a list" : "an object", json.size());
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

std::string member(const std::string& at, const std::string& name) {
  std::string key = name.substr(0, 200);
  // Control characters would break the message into several lines.
  std::ranges::replace_if(
      key, [](unsigned char c) { return c < 0x20; }, '?');
  return at + (Json::json_pointer() / key).to_string();
}

std::string element(const std::string& at, std::size_t index) {
  return at + "/" + std::to_string(index);
}

}  // namespace hapbench
