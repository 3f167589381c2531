#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "results/observe/force_fidelity.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// A recorded stroke: the motion of the tool and, optionally, the force on it that was measured at the same time.
struct Stroke {
  RecordedMotion motion;
  std::optional<ReferenceForce> force;
};

/// The stroke in the contents of a CSV file with the header time_s,px_m,py_m,pz_m, then axis_x,axis_y,axis_z or
/// qw,qx,qy,qz, then perhaps a measured force mfx_N,mfy_N,mfz_N. Times must increase strictly, axes must not be zero,
/// and quaternions must have norm 1 within 0.001; both are normalised. A quaternion turns the tool's frame, whose axis
/// points along -z, into the world's. Throws InputError that names the sample.
Stroke stroke_in(std::string_view text, const std::filesystem::path& file);

/// The contacts in a CSV file with the header time_s,x_m,y_m,z_m,ux,uy,uz,depth_m: at most 20 million, 100 000 of one
/// time. Times must not fall, depths must not be below 0, and gradients, normalised unless unit to rounding, must be
/// unit to 0.001. Throws InputError that names the contact.
ContactTrace trace_in(std::string_view text, const std::filesystem::path& file);

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
