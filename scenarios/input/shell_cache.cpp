#include "scenarios/input/shell_cache.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>
#include <type_traits>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/size_limits.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// Six doubles without gaps, so that a file can hold points as they lie in memory. The byte order is this machine's:
// definitions name the machine code, which another byte order does not share.
static_assert(std::is_standard_layout_v<SurfacePoint> && sizeof(SurfacePoint) == 6 * sizeof(double));

constexpr std::array<char, 8> kMagic = {'h', 'a', 'p', 's', 'h', 'e', 'l', '2'};
constexpr const char* kExtension = ".shell";

/// What a file starts with; the definition, the points and their cells follow.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint64_t definition_size = 0;  ///< [bytes]
  std::uint64_t points = 0;
  std::uint64_t cells = 0;     ///< as many as points, or none
  std::uint64_t checksum = 0;  ///< of everything else
};

/// Each round of the hash can be undone, so one changed bit, byte or word always changes the sum.
std::uint64_t checksum(const Header& header, std::string_view definition, const ShellPoints& shell) {
  Hash64 hash;
  hash.bytes({header.magic.data(), header.magic.size()});
  hash.word(header.definition_size);
  hash.word(header.points);
  hash.word(header.cells);
  hash.bytes(definition);
  for (const SurfacePoint& point : shell.points) {
    for (const double value : point.position) hash.real(value);
    for (const double value : point.normal) hash.real(value);
  }
  for (const std::uint32_t cell : shell.cells) hash.word(cell);
  return hash.value();
}

std::uintmax_t file_size(const Header& header) {
  return sizeof(Header) + header.definition_size + header.points * sizeof(SurfacePoint) +
         header.cells * sizeof(std::uint32_t);
}

template <class T>
std::string_view bytes_of(const T* objects, std::size_t count) {
  return {reinterpret_cast<const char*>(objects), count * sizeof(T)};
}

template <class T>
bool read(std::ifstream& stream, T* objects, std::size_t count) {
  stream.read(reinterpret_cast<char*>(objects), static_cast<std::streamsize>(count * sizeof(T)));
  return stream.good();
}

/// The shell in the file when it is whole and of this definition. Sizes are believed only when the file has them.
std::optional<ShellPoints> read_entry(const fs::path& file, const std::string& definition) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};  // opening a pipe would wait for its writer
  std::ifstream stream(file, std::ios::binary);
  Header header;
  if (!read(stream, &header, 1) || header.magic != kMagic || header.definition_size != definition.size()) return {};
  if (header.points > static_cast<std::uint64_t>(kMostPoints)) return {};
  if (header.cells != 0 && header.cells != header.points) return {};
  if (fs::file_size(file, error) != file_size(header)) return {};
  std::string stored(definition.size(), '\0');
  if (!read(stream, stored.data(), stored.size()) || stored != definition) return {};
  ShellPoints shell{std::vector<SurfacePoint>(header.points), std::vector<std::uint32_t>(header.cells)};
  if (!read(stream, shell.points.data(), shell.points.size())) return {};
  if (!read(stream, shell.cells.data(), shell.cells.size())) return {};
  if (checksum(header, definition, shell) != header.checksum) return {};
  return shell;
}

struct Entry {
  fs::path file;
  std::uintmax_t bytes;
  fs::file_time_type last_use;
};

/// The shells in the directory; other files are none of ours.
std::vector<Entry> entries(const fs::path& directory) {
  std::vector<Entry> found;
  std::error_code error;
  for (fs::directory_iterator file(directory, error); !error && file != fs::directory_iterator();
       file.increment(error)) {
    std::error_code gone;  // removed by another process meanwhile
    if (file->path().extension() != kExtension || !file->is_regular_file(gone)) continue;
    const Entry entry{file->path(), file->file_size(gone), file->last_write_time(gone)};
    if (!gone) found.push_back(entry);
  }
  return found;
}

/// Removes the entries used longest ago until the others are at most `largest` bytes together.
void remove_oldest(const fs::path& directory, std::uintmax_t largest) {
  std::vector<Entry> all = entries(directory);
  std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.last_use > b.last_use; });
  std::uintmax_t bytes = 0;
  for (const Entry& entry : all) {
    bytes += entry.bytes;
    std::error_code ignored;
    if (bytes > largest) fs::remove(entry.file, ignored);
  }
}

/// The variable's value; none when it is not set or, like a relative path in the base directory specification, void.
std::optional<fs::path> absolute_path_in(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) return {};
  return value;
}

}  // namespace

ShellCache::ShellCache(fs::path directory, std::uintmax_t largest)
    : directory_(std::move(directory)), largest_(largest) {}

fs::path ShellCache::entry(const std::string& definition) const {
  return directory_ / (hash_text(hash_of(definition)) + kExtension);
}

std::optional<ShellPoints> ShellCache::find(const std::string& definition) const noexcept {
  if (!is_on()) return {};
  try {
    const fs::path file = entry(definition);
    std::optional<ShellPoints> shell = read_entry(file, definition);
    std::error_code ignored;
    if (shell) fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
    return shell;
  } catch (const std::exception&) {  // no memory for the file's points
    return {};
  }
}

void ShellCache::keep(const std::string& definition, const ShellPoints& shell) const noexcept {
  Header header;
  header.definition_size = definition.size();
  header.points = shell.points.size();
  header.cells = shell.cells.size();
  if (!is_on() || file_size(header) > largest_) return;
  header.checksum = checksum(header, definition, shell);
  try {
    fs::create_directories(directory_);
    remove_stale_temporaries(directory_);
    AtomicFile file(entry(definition));
    file.append(bytes_of(&header, 1));
    file.append(definition);
    file.append(bytes_of(shell.points.data(), shell.points.size()));
    file.append(bytes_of(shell.cells.data(), shell.cells.size()));
    file.commit();
    remove_oldest(directory_, largest_);
  } catch (const std::exception&) {
    // No such directory, no permission, no space: the next process builds the shell again.
  }
}

ShellCache::Contents ShellCache::contents() const {
  Contents contents;
  for (const Entry& entry : entries(directory_)) {
    ++contents.shells;
    contents.bytes += entry.bytes;
  }
  return contents;
}

fs::path shell_cache_directory() {
  if (const char* chosen = std::getenv("HAPBENCH_CACHE_DIR")) return chosen;
  if (const auto caches = absolute_path_in("XDG_CACHE_HOME")) return *caches / "hapbench";
  if (const auto home = absolute_path_in("HOME")) return *home / ".cache" / "hapbench";
  return {};
}

}  // namespace hapbench
