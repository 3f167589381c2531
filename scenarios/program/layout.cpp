#include "scenarios/program/layout.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "scenarios/program/text.hpp"

namespace hapbench {

namespace {

/// Smallest width [characters] in which a name and its meaning fit beside each other.
constexpr std::size_t kMinWidth = 40;

/// Returns the environment variable COLUMNS. If it is not set, returns the width of the terminal, or npos if standard
/// output is not a terminal. Returns kMinWidth instead of a smaller width.
std::size_t output_width() {
  const char* columns = std::getenv("COLUMNS");
  if (const long given = columns == nullptr ? 0 : std::atol(columns); given > 0)
    return std::max(kMinWidth, static_cast<std::size_t>(given));
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return std::string::npos;
  return std::max<std::size_t>(kMinWidth, size.ws_col);
}

}  // namespace

Layout Layout::of_output(bool in_full) {
  return Layout(in_full ? std::string::npos : output_width(), in_full);
}

std::size_t Layout::prose_width() const {
  return std::min<std::size_t>(width_, 100);
}

std::string Layout::wrapped(std::string_view text, std::size_t indent) const {
  return hapbench::wrapped(text, indent, prose_width());
}

std::string Layout::entry(std::string_view name, std::string_view meaning, std::size_t indent,
                          std::size_t column) const {
  return hapbench::entry(name, meaning, indent, column, prose_width());
}

}  // namespace hapbench
