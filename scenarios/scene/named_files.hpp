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

// JSON pointers of the fields whose files the program looks up by NamedFiles::find() or NamedFiles::at().
inline constexpr std::string_view kEnvironmentFile = "/environment/file";
inline constexpr std::string_view kToolFile = "/tool/file";
inline constexpr std::string_view kMotionFile = "/motion/position/file";
inline constexpr std::string_view kContactFile = "/rendering/contact_source/file";

/// A file that a scenario names. It is read and parsed on first use. Scenarios that read the same contents with
/// the same parameters share the result (SharedCache). Later changes of the file do not affect an object that has
/// read it. Functions that need the contents throw InputError if the file cannot be read or is invalid.
class NamedFile {
 public:
  NamedFile(std::string pointer, std::filesystem::path path, const FileContent& content)
      : pointer_(std::move(pointer)), path_(std::move(path)), content_(content) {}

  const std::string& pointer() const { return pointer_; }
  const std::filesystem::path& path() const { return path_; }

  /// Returns the FNV-1a hash of the file's bytes as 16 hexadecimal digits.
  const std::string& hash() { return read().hash; }
  /// Reads and parses the file. Throws InputError if the file is invalid.
  void check() { read(); }
  /// Returns warnings about the contents. They name the file without its folder.
  std::vector<Warning> warnings();

  // Precondition of the functions below: the file's content has the requested kind.

  /// Returns points with normals.
  const std::vector<SurfacePoint>& points() { return std::get<std::vector<SurfacePoint>>(read().contents); }
  const MeshFile& mesh() { return std::get<MeshFile>(read().contents); }
  // The returned object may outlive this NamedFile.
  std::shared_ptr<const Stroke> stroke() { return kept<Stroke>(); }
  std::shared_ptr<const ContactTrace> trace() { return kept<ContactTrace>(); }

 private:
  /// Parsed contents; empty for a shared library, which load_module.hpp loads.
  using Contents = std::variant<std::monostate, std::vector<SurfacePoint>, MeshFile, Stroke, ContactTrace>;

  struct Read {
    std::string hash;
    Contents contents;
    /// Notes about columns and values that the reader of a table ignored or assumed (NumberTable::notes).
    std::vector<std::string> notes;
  };

  /// Returns the contents as a pointer that shares ownership of everything that was read.
  template <class Kind>
  std::shared_ptr<const Kind> kept() {
    const Kind& kind = std::get<Kind>(read().contents);
    return {read_, &kind};
  }
  /// Reads and parses the file on the first call. Returns the hash and the contents.
  const Read& read();
  Contents parsed(std::string_view bytes, std::vector<std::string>& notes) const;

  std::string pointer_;
  std::filesystem::path path_;
  FileContent content_;
  std::shared_ptr<const Read> read_;  ///< null until the file has been read
};

/// All files that a scenario names, in the order of its fields. Used to load, check and hash the files and to
/// rewrite their paths. Copies share the files. Two threads must not use an object, or copies of it, at the same
/// time.
class NamedFiles {
 public:
  NamedFiles() = default;
  explicit NamedFiles(Scenario scenario);

  const std::vector<std::shared_ptr<NamedFile>>& all() const { return files_; }
  /// Returns the file that the field at a JSON pointer names, or null if the scenario has no such field.
  NamedFile* find(std::string_view pointer) const;
  /// Returns the file that the field at a JSON pointer names. Precondition: the scenario has that field.
  NamedFile& at(std::string_view pointer) const { return *find(pointer); }

 private:
  std::vector<std::shared_ptr<NamedFile>> files_;
};

}  // namespace hapbench
