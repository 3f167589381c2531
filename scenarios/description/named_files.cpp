#include "scenarios/description/named_files.hpp"

#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/motion_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {

void NamedFile::read() {
  if (!hash_.empty()) return;
  bytes_ = read_named_file(path_);
  hash_ = hash_text(hash_of(bytes_));
}

const std::string& NamedFile::hash() {
  read();
  return hash_;
}

const std::string& NamedFile::bytes() {
  read();
  return bytes_;
}

NamedFiles::NamedFiles(const Scenario& scenario) {
  if (const auto* shell = std::get_if<PointShellEnvironment>(&scenario.environment))
    environment_ = std::make_shared<EnvironmentFile>(EnvironmentFile{NamedFile(resolve_path(scenario, shell->file))});
  if (const auto* mesh = std::get_if<MeshEnvironment>(&scenario.environment)) {
    environment_ = std::make_shared<EnvironmentFile>(
        EnvironmentFile{NamedFile(resolve_path(scenario, mesh->file)), {mesh->scale, mesh->spacing}});
  }
  if (const auto* tool = std::get_if<MeshToolFields>(&scenario.tool))
    tool_ = std::make_shared<ToolFile>(ToolFile{NamedFile(resolve_path(scenario, tool->file)), tool->scale});
  if (const auto* recorded = std::get_if<RecordedPosition>(&scenario.motion.position))
    motion_ = std::make_shared<MotionFile>(MotionFile{NamedFile(resolve_path(scenario, recorded->file))});
}

const std::vector<SurfacePoint>& NamedFiles::shell_points() const {
  auto& [file, sampling, points, mesh] = *environment_;
  if (!points) {
    shell_extension(file.path());  // refused unread if it is another
    points = point_shell_in(file.bytes(), file.path());
    file.drop_bytes();
  }
  return *points;
}

const MeshFile& NamedFiles::mesh() const {
  auto& [file, sampling, points, mesh] = *environment_;
  if (!mesh) {
    mesh_extension(file.path());  // refused unread if it is another
    mesh.emplace(file.bytes(), file.path(), sampling);
    file.drop_bytes();
  }
  return *mesh;
}

const MeshFile& NamedFiles::tool_mesh() const {
  auto& [file, scale, mesh] = *tool_;
  if (!mesh) {
    mesh_extension(file.path());  // refused unread if it is another
    mesh.emplace(file.bytes(), file.path(), MeshSampling{scale, {}});
    file.drop_bytes();
  }
  return *mesh;
}

const RecordedMotion& NamedFiles::recorded_motion() const {
  auto& [file, motion, force] = *motion_;
  if (!motion) {
    Stroke stroke = stroke_in(file.bytes(), file.path());
    motion = std::move(stroke.motion);
    if (stroke.force) force = std::make_shared<const ReferenceForce>(*std::move(stroke.force));
    file.drop_bytes();
  }
  return *motion;
}

std::shared_ptr<const ReferenceForce> NamedFiles::recorded_force() const {
  recorded_motion();
  return motion_->force;
}

}  // namespace hapbench
