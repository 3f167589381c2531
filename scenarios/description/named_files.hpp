#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "results/observe/force_fidelity.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// A file that a scenario names. It is read once, when something of it is first asked for.
class NamedFile {
 public:
  explicit NamedFile(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  /// FNV-1a of its bytes, as 16 hexadecimal digits. Throws InputError when it cannot be read.
  const std::string& hash();
  /// Its bytes, until they are dropped. Throws InputError when it cannot be read.
  const std::string& bytes();
  void drop_bytes() { bytes_ = {}; }

 private:
  void read();

  std::filesystem::path path_;
  std::string hash_;  ///< empty until the file is read
  std::string bytes_;
};

/// The files that a scenario names, each read and parsed once. Copies share what was read, and must
/// not be used by two threads at once. Functions that return contents throw InputError if the file cannot be used.
class NamedFiles {
 public:
  /// No files, for a scenario that names none.
  NamedFiles() = default;
  explicit NamedFiles(const Scenario& scenario);

  /// The files; null when the scenario names none.
  NamedFile* environment() const { return environment_ ? &environment_->file : nullptr; }
  NamedFile* motion() const { return motion_ ? &motion_->file : nullptr; }
  NamedFile* tool() const { return tool_ ? &tool_->file : nullptr; }

  /// The points of an environment that is a point shell. Precondition: it is one.
  const std::vector<SurfacePoint>& shell_points() const;
  /// The surface of an environment that is a mesh. Precondition: it is one.
  const MeshFile& mesh() const;
  /// The surface of a tool that is a mesh. Precondition: it is one.
  const MeshFile& tool_mesh() const;
  /// Precondition: the motion is a recorded one.
  const RecordedMotion& recorded_motion() const;
  /// The force that was measured with it; null without one. Precondition: the motion is a recorded one.
  std::shared_ptr<const ReferenceForce> recorded_force() const;

 private:
  struct EnvironmentFile {
    NamedFile file;
    MeshSampling sampling = {};  ///< of a mesh
    std::optional<std::vector<SurfacePoint>> points = {};
    std::optional<MeshFile> mesh = {};
  };
  struct ToolFile {
    NamedFile file;
    double scale;
    std::optional<MeshFile> mesh = {};
  };
  struct MotionFile {
    NamedFile file;
    std::optional<RecordedMotion> motion = {};
    std::shared_ptr<const ReferenceForce> force = {};
  };

  std::shared_ptr<EnvironmentFile> environment_;
  std::shared_ptr<ToolFile> tool_;
  std::shared_ptr<MotionFile> motion_;
};

}  // namespace hapbench
