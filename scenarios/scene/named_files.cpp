#include "scenarios/scene/named_files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <optional>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/point_shell_file.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/describe_scenario.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// Returns a text that changes whenever the file changes, so that a cached file need not be read again. Returns
/// nullopt if the file is not a regular file. Also returns nullopt if the file changed within the last 2 s: a
/// further change might then get the same time stamp, because file systems store times with a coarse resolution.
std::optional<std::string> stamp_of(const std::filesystem::path& file) {
  struct stat s {};
  if (::stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return std::nullopt;
  constexpr std::time_t kSettled = 2;  // minimum age of the last change [s]
  if (std::time(nullptr) < std::max(s.st_mtim.tv_sec, s.st_ctim.tv_sec) + kSettled) return std::nullopt;
  return fmt::format("stamp {} {} {} {} {} {} {}", s.st_dev, s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec,
                     s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
}

}  // namespace

const NamedFile::Read& NamedFile::read() {
  if (read_) return *read_;
  // Check the extension.
  if (content_.kind == FileContent::Kind::point_shell) shell_extension(path_);
  if (content_.kind == FileContent::Kind::mesh) mesh_extension(path_);
  // Identify the contents by the file's time stamps or, if they are not reliable, by a hash. The time stamps are
  // taken before reading. If the file changes during reading, it will never have these time stamps again.
  std::optional<std::string> bytes, state = stamp_of(path_);
  if (!state) {
    bytes = read_named_file(path_);
    state = hash_text(hash_of(*bytes));
  }
  // Parse the contents, or take them from the cache.
  const std::string key = fmt::format("file {} as {}, scale {}, spacing {}, flip {}: {}", *state,
                                      static_cast<int>(content_.kind), content_.sampling.scale,
                                      content_.sampling.spacing.value_or(0.0), content_.sampling.flip, path_.string());
  const auto parse = [&] {
    if (!bytes) bytes = read_named_file(path_);
    std::vector<std::string> notes;
    Contents contents = parsed(*bytes, notes);
    return std::make_shared<const Read>(Read{hash_text(hash_of(*bytes)), std::move(contents), std::move(notes)});
  };
  // A parsed mesh needs about 4 times the memory of its text; the same is assumed for other files.
  read_ = shared_cache().get<Read>(key, parse, [&bytes](const Read&) { return 4 * (bytes ? bytes->size() : 0); });
  return *read_;
}

NamedFile::Contents NamedFile::parsed(std::string_view bytes, std::vector<std::string>& notes) const {
  switch (content_.kind) {
    case FileContent::Kind::point_shell:
      return parse_point_shell(bytes, path_, &notes);
    case FileContent::Kind::mesh:
      return MeshFile(bytes, path_, content_.sampling);
    case FileContent::Kind::stroke:
      return parse_stroke(bytes, path_, &notes);
    case FileContent::Kind::trace:
      return parse_contact_trace(bytes, path_, &notes);
    case FileContent::Kind::library:
      break;
  }
  return {};
}

std::vector<Warning> NamedFile::warnings() {
  std::vector<Warning> warnings;
  for (const std::string& note : read().notes)
    warnings.push_back({"table_file", pointer_, fmt::format("{}, {}", path_.filename().string(), note)});
  if (content_.kind != FileContent::Kind::mesh) return warnings;
  for (const std::string& text : mesh().warnings(path_)) warnings.push_back({"mesh_file", pointer_, text});
  return warnings;
}

NamedFiles::NamedFiles(Scenario scenario) {
  // json_of() calls `add` for each field that names a file.
  const auto add = [&](const std::string& pointer, const std::string& path, const FileContent& content) {
    files_.push_back(std::make_shared<NamedFile>(pointer, scenario.directory / path, content));
  };
  json_of([&scenario](Fields& f) { f.object(scenario); }, add);
}

NamedFile* NamedFiles::find(std::string_view pointer) const {
  const auto found = std::ranges::find(files_, pointer, &NamedFile::pointer);
  return found == files_.end() ? nullptr : found->get();
}

}  // namespace hapbench
