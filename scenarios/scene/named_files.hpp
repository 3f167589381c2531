#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/scene/recordings.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/trace_source.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

// Pointers of the files that have a use of their own.
inline constexpr std::string_view kEnvironmentFile = "/environment/file";
inline constexpr std::string_view kToolFile = "/tool/file";
inline constexpr std::string_view kMotionFile = "/motion/position/file";
inline constexpr std::string_view kContactFile = "/rendering/contact_source/file";

/// A file that a scenario names. It is read and parsed when something of it is first asked for, once for all scenarios
/// that take the same contents alike (SharedCache), and stays as it was then for this one. Functions that need its
/// contents throw InputError when they cannot be used.
class NamedFile {
 public:
  NamedFile(std::string pointer, std::filesystem::path path, const FileContent& content)
      : pointer_(std::move(pointer)), path_(std::move(path)), content_(content) {}

  const std::string& pointer() const { return pointer_; }
  const std::filesystem::path& path() const { return path_; }

  /// FNV-1a of its bytes, as 16 hexadecimal digits.
  const std::string& hash() { return read().hash; }
  /// Reads and parses the file.
  void check() { read(); }
  /// Warnings about its contents, without the file's directory.
  std::vector<Warning> warnings();

  /// The points with normals. Precondition, here and below: the content is of that kind.
  const std::vector<SurfacePoint>& points() { return std::get<std::vector<SurfacePoint>>(read().contents); }
  const MeshFile& mesh() { return std::get<MeshFile>(read().contents); }
  // These may be kept longer than the file.
  std::shared_ptr<const Stroke> stroke() { return kept<Stroke>(); }
  std::shared_ptr<const ContactTrace> trace() { return kept<ContactTrace>(); }

 private:
  /// Nothing of a library, whose code is loaded elsewhere.
  using Contents = std::variant<std::monostate, std::vector<SurfacePoint>, MeshFile, Stroke, ContactTrace>;

  struct Read {
    std::string hash;
    Contents contents;
  };

  template <class Kind>
  std::shared_ptr<const Kind> kept() {
    const Kind& kind = std::get<Kind>(read().contents);
    return {read_, &kind};
  }
  const Read& read();
  Contents parsed(std::string_view bytes) const;

  std::string pointer_;
  std::filesystem::path path_;
  FileContent content_;
  std::shared_ptr<const Read> read_;  ///< null until something of it is asked for
};

/// Every file that a scenario names, in the order of its fields: by this list files are loaded, checked, hashed and
/// rewritten. Copies share what was read, and must not be used by two threads at once.
class NamedFiles {
 public:
  NamedFiles() = default;
  explicit NamedFiles(Scenario scenario);

  const std::vector<std::shared_ptr<NamedFile>>& all() const { return files_; }
  /// The file that the field at a JSON pointer names; null when the scenario has no such field.
  NamedFile* find(std::string_view pointer) const;
  /// Precondition: the scenario has that field.
  NamedFile& at(std::string_view pointer) const { return *find(pointer); }

 private:
  std::vector<std::shared_ptr<NamedFile>> files_;
};

}  // namespace hapbench
