#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/narrowphase/collision.h>

#include "tests/bench/peers/contact_library.hpp"

/// FCL. Its cylinder is tested against triangles in a tree of oriented boxes with rectangle swept spheres, which is
/// FCL's default for meshes. Each triangle that the cylinder meets is a contact. The depth of the contact is the length
/// of the shortest translation that separates triangle and cylinder, as libccd approximates it (EPA).
namespace hapbench::bench {
namespace {

using Surface = fcl::BVHModel<fcl::OBBRSSd>;

class Fcl final : public Peer {
 public:
  explicit Fcl(const HapbenchRun& run) {
    std::vector<fcl::Vector3d> vertices;
    for (std::size_t i = 0; i < 3 * run.vertex_count; i += 3)
      vertices.emplace_back(run.vertices[i], run.vertices[i + 1], run.vertices[i + 2]);
    std::vector<fcl::Triangle> triangles;
    for (std::size_t i = 0; i < 3 * run.triangle_count; i += 3)
      triangles.emplace_back(run.triangles[i], run.triangles[i + 1], run.triangles[i + 2]);
    auto model = std::make_shared<Surface>();
    model->beginModel();
    model->addSubModel(vertices, triangles);
    model->endModel();
    surface_ = std::make_unique<fcl::CollisionObjectd>(model);
    tool_ = std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Cylinderd>(run.tool_radius, run.tool_length));
  }

  std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) override {
    const auto& r = pose.rotation;
    fcl::Matrix3d rotation;
    rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    tool_->setTransform(rotation, fcl::Vector3d(pose.centre[0], pose.centre[1], pose.centre[2]));
    const fcl::CollisionRequestd request(room.size(), true);
    fcl::CollisionResultd result;
    fcl::collide(surface_.get(), tool_.get(), request, result);
    const std::size_t found = std::min(result.numContacts(), room.size());
    for (std::size_t i = 0; i < found; ++i) room[i].depth = result.getContact(i).penetration_depth;
    return found;
  }

 private:
  std::unique_ptr<fcl::CollisionObjectd> surface_, tool_;
};

}  // namespace

std::unique_ptr<Peer> fcl(const HapbenchRun& run) {
  return std::make_unique<Fcl>(run);
}

}  // namespace hapbench::bench
