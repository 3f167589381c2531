#include "scenarios/files/json_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

namespace hapbench {
namespace {

constexpr int kDeepestNesting = 64;
constexpr std::size_t kMostKeys = 10'000;

/// Line and column, both from 1, of a byte offset.
std::string line_and_column(const std::string& text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  const auto line = 1 + std::count(text.begin(), end, '\n');
  const std::size_t start = text.rfind('\n', byte == 0 ? 0 : std::min(byte, text.size()) - 1);
  const std::size_t column = start == std::string::npos || start >= byte ? byte : byte - start - 1;
  return fmt::format("line {}, column {}", line, std::max<std::size_t>(column, 1));
}

/// Watches the parser's events for what the parser itself would accept.
class Guard {
 public:
  bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    if (event == Event::object_start || event == Event::array_start) {
      if (depth >= kDeepestNesting) {
        throw InputError(InputError::Kind::shape, "", fmt::format("nested too deeply; allowed: {} levels", kDeepestNesting));
      }
      if (event == Event::object_start) keys_.emplace_back();
    } else if (event == Event::object_end) {
      keys_.pop_back();
    } else if (event == Event::key) {
      check_key(parsed.get_ref<const std::string&>());
    }
    return true;
  }

 private:
  void check_key(const std::string& key) {
    std::set<std::string>& seen = keys_.back();
    if (!seen.insert(key).second) {
      throw InputError(InputError::Kind::shape, "", "the key " + shown(Json(key)) + " stands twice in one object");
    }
    if (seen.size() > kMostKeys) {
      throw InputError(InputError::Kind::shape, "", fmt::format("an object has more than {} keys", kMostKeys));
    }
  }

  std::vector<std::set<std::string>> keys_;  ///< of the objects that are open
};

}  // namespace

std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw InputError("is a directory, not a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("cannot be read: {}", std::strerror(errno)));
  // Read in pieces up to the limit rather than trust a size, which pipes and devices do not have.
  std::string text;
  std::vector<char> piece(1 << 16);
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
    text.append(piece.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > largest) throw InputError(fmt::format("is larger than {} MiB", largest >> 20));
  }
  return text;
}

Json parse_json(const std::string& text) {
  Guard guard;
  try {
    return Json::parse(text, [&guard](int depth, Json::parse_event_t event, Json& parsed) { return guard(depth, event, parsed); });
  } catch (const Json::parse_error& error) {
    throw InputError(InputError::Kind::shape, "", fmt::format("is not JSON: syntax error at {}", line_and_column(text, error.byte)));
  } catch (const Json::out_of_range&) {
    throw InputError(InputError::Kind::shape, "", "has a number that is too large; allowed: finite numbers");
  }
}

}  // namespace hapbench
