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
  for (const std::string& text : mesh().warnings(path_)) warnings.push_back({"mesh_file", pointer_, text});
  return warnings;
}

NamedFiles::NamedFiles(Scenario scenario) {
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
