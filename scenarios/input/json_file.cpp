#include "scenarios/input/json_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

constexpr int kMaxNesting = 64;           ///< maximum number of nested objects and lists; bounds the recursion
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

/// Returns the likely cause of a syntax error at a byte (from 1), with the correction, beginning with "; ". Empty if
/// the cause is not known.
std::string cause_of_syntax_error(std::string_view text, std::size_t byte) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t at = std::min(byte > 0 ? byte - 1 : 0, text.size());
  const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  // Find the start of the token and the character before it.
  std::size_t start = at;
  while (start > 0 && std::isalnum(static_cast<unsigned char>(text[start - 1])) != 0) --start;
  const std::size_t before = text.substr(0, start).find_last_not_of(kBlank);
  const bool follows_comma = before != std::string_view::npos && text[before] == ',';
  const std::string_view token = text.substr(start, 9);
  if (token.starts_with("/") || token.starts_with("#") || (start > 0 && text.substr(start - 1).starts_with("//")))
    return "; JSON has no comments";
  if (follows_comma && (token.starts_with("}") || token.starts_with("]"))) return "; remove the comma before it";
  if (follows_comma && before > 0 && is_digit(before - 1) && is_digit(start))
    return "; a decimal comma? write a decimal point";
  if (token.starts_with("'")) return "; write double quotes around names and texts";
  for (const auto& [word, correction] :
       {std::pair("True", "true"), {"False", "false"}, {"None", "null"}, {"nan", "null"}, {"NaN", "null"}})
    if (token.starts_with(word)) return fmt::format("; write {}", correction);
  return "";
}

/// Returns the position of a byte (from 1) of the text, as an editor shows it: "line 2, column 5". Columns count
/// characters.
std::string position_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  LineReader lines(before);
  std::string_view last;
  while (const auto line = lines.next()) last = *line;
  const bool is_at_start = lines.line() == 0 || lines.has_line_end();
  return fmt::format("line {}, column {}", lines.line() + (is_at_start ? 1 : 0),
                     is_at_start ? 1 : count_characters(last) + 1);
}

/// Throws InputError for a number that is too small for double precision, such as 1e-400, which the parser would read
/// as 0. Precondition: the text is valid JSON.
void refuse_underflow(std::string_view text) {
  bool is_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') is_text = !is_text;
    if (is_text) {
      i += text[i] == '\\';  // skips the character after a backslash
      continue;
    }
    if (text[i] != '-' && (text[i] < '0' || text[i] > '9')) continue;
    const std::size_t end = std::min(text.find_first_not_of("+-.0123456789eE", i), text.size());
    const std::string_view number = text.substr(i, end - i);
    double value = 0.0;
    if (std::from_chars(number.data(), number.data() + number.size(), value).ec == std::errc::result_out_of_range) {
      throw InputError(InputError::Kind::shape, "",
                       fmt::format("{}: got {}; allowed: 0, or a number that double precision can represent",
                                   position_of(text, i + 1), quoted_token(number)));
    }
    i = end - 1;
  }
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
    Json json = Json::parse(
        text, [&guard](int depth, Json::parse_event_t event, Json& parsed) { return guard(depth, event, parsed); });
    refuse_underflow(text);
    return json;
  } catch (const Json::parse_error& error) {
    // Take the description out of a message such as
    // "[json.exception.parse_error.101] parse error at line 2, column 5: syntax error while ...; last read: '...'"
    const std::string message = error.what();
    const std::size_t start = message.find(": ", message.find("] ")) + 2;
    refuse_syntax(fmt::format("parse error at {}: {}{}", position_of(text, error.byte),
                              message.substr(start, message.find("; last read") - start),
                              cause_of_syntax_error(text, error.byte)));
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
