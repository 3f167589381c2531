#include "scenarios/format/named_files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <optional>
#include <thread>

#include "scenarios/format/input_error.hpp"
#include "scenarios/format/mesh_file.hpp"
#include "scenarios/format/parts.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/format/writer.hpp"
#include "sim/core/hash.hpp"
#include "sim/core/parallel.hpp"

namespace hapbench {

std::shared_ptr<const void> SharedCache::get_untyped(const std::string& key, const std::function<Made()>& make) {
  const std::shared_ptr<Entry> entry = entry_of(key);
  const std::lock_guard lock(entry->mutex);
  if (entry->made.value) return entry->made.value;
  // Isolated, or this thread might take up another run while it waits, and wait for itself at the lock.
  Made made = isolate(make);
  const std::lock_guard list_lock(mutex_);
  entry->made = std::move(made);
  ++made_;
  return entry->made.value;
}

std::shared_ptr<SharedCache::Entry> SharedCache::entry_of(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_, key, &Entry::key);
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
  } else {
    entries_.push_front(std::make_shared<Entry>());
    entries_.front()->key = key;
    drop_oldest();
  }
  return entries_.front();
}

void SharedCache::drop_oldest() {
  const std::size_t fewest = 2 * std::max(1u, std::thread::hardware_concurrency());
  std::size_t bytes = 0;
  for (const auto& entry : entries_) bytes += entry->made.bytes;
  while (entries_.size() > fewest && (entries_.size() > kMost || bytes > kMostBytes)) {
    bytes -= entries_.back()->made.bytes;
    entries_.pop_back();
  }
}

SharedCache& shared_cache() {
  static SharedCache cache;
  return cache;
}

namespace {

/// A text that differs after a change of the file, so that a known file need not be read again. Nothing for a file that
/// is not regular, or that changed so recently that the clock of the file system might not tell the next change.
std::optional<std::string> stamp_of(const std::filesystem::path& file) {
  struct stat s {};
  if (::stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return std::nullopt;
  constexpr std::time_t kSettled = 2;  // [s]
  if (std::time(nullptr) < std::max(s.st_mtim.tv_sec, s.st_ctim.tv_sec) + kSettled) return std::nullopt;
  return fmt::format("stamp {} {} {} {} {} {} {}", s.st_dev, s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec,
                     s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
}

}  // namespace

const NamedFile::Read& NamedFile::read() {
  if (read_) return *read_;
  if (content_.kind == FileContent::Kind::point_shell) shell_extension(path_);
  if (content_.kind == FileContent::Kind::mesh) mesh_extension(path_);
  std::string bytes;
  // Kept under the stamp of before the reading, which a file that changed meanwhile never has again.
  std::optional<std::string> state = stamp_of(path_);
  if (!state) {
    bytes = read_named_file(path_);
    state = hash_text(hash_of(bytes));
  }
  const std::string key = fmt::format("file {} as {}, scale {}, spacing {}, flip {}: {}", *state,
                                      static_cast<int>(content_.kind), content_.sampling.scale,
                                      content_.sampling.spacing.value_or(0.0), content_.sampling.flip, path_.string());
  const auto parse = [&] {
    if (bytes.empty()) bytes = read_named_file(path_);
    return std::make_shared<const Read>(Read{hash_text(hash_of(bytes)), parsed(bytes)});
  };
  // A parsed mesh takes some times the space of its text.
  read_ = shared_cache().get<Read>(key, parse, [&bytes](const Read&) { return 4 * bytes.size(); });
  return *read_;
}

NamedFile::Contents NamedFile::parsed(std::string_view bytes) const {
  switch (content_.kind) {
    case FileContent::Kind::point_shell:
      return point_shell_in(bytes, path_);
    case FileContent::Kind::mesh:
      return MeshFile(bytes, path_, content_.sampling);
    case FileContent::Kind::stroke:
      return stroke_in(bytes, path_);
    case FileContent::Kind::trace:
      return trace_in(bytes, path_);
    case FileContent::Kind::library:
      break;
  }
  return {};
}

std::vector<Warning> NamedFile::warnings() {
  std::vector<Warning> warnings;
  if (content_.kind != FileContent::Kind::mesh) return warnings;
  for (const std::string& text : mesh().warnings()) warnings.push_back({"mesh_file", pointer_, text});
  return warnings;
}

NamedFiles::NamedFiles(Scenario scenario) {
  std::vector<FoundFile> found;
  json_of([&scenario](Fields& f) { f.object(scenario); }, &found);
  for (const FoundFile& file : found)
    files_.push_back(std::make_shared<NamedFile>(file.pointer, scenario.directory / file.path, file.content));
}

NamedFile* NamedFiles::find(std::string_view pointer) const {
  const auto found = std::ranges::find(files_, pointer, &NamedFile::pointer);
  return found == files_.end() ? nullptr : found->get();
}

}  // namespace hapbench
