#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/narrowphase/collision.h>

#include "algorithms/peers/peer.hpp"

/// FCL: triangles in a tree of oriented boxes with rectangle swept spheres, its default for meshes, against its
/// cylinder. Each triangle that the cylinder meets is a contact; depth and direction are those of the shortest
/// translation that parts the two, as libccd approximates it (EPA).
namespace hapbench {
namespace {

using Surface = fcl::BVHModel<fcl::OBBRSSd>;

class Fcl final : public Peer {
 public:
  Fcl(const PeerSurface& surface, const PeerDrill& drill) {
    std::vector<fcl::Vector3d> vertices;
    for (std::size_t i = 0; i < surface.vertices.size(); i += 3)
      vertices.emplace_back(surface.vertices[i], surface.vertices[i + 1], surface.vertices[i + 2]);
    std::vector<fcl::Triangle> triangles;
    for (std::size_t i = 0; i < surface.triangles.size(); i += 3)
      triangles.emplace_back(surface.triangles[i], surface.triangles[i + 1], surface.triangles[i + 2]);
    auto model = std::make_shared<Surface>();
    model->beginModel();
    model->addSubModel(vertices, triangles);
    model->endModel();
    surface_ = std::make_unique<fcl::CollisionObjectd>(model);
    tool_ = std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Cylinderd>(drill.radius, drill.length));
  }

  std::size_t contacts_at(const PeerPose& pose, std::span<PeerContact> room) override {
    const auto& r = pose.rotation;
    fcl::Matrix3d rotation;
    rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    tool_->setTransform(rotation, fcl::Vector3d(pose.centre[0], pose.centre[1], pose.centre[2]));
    const fcl::CollisionRequestd request(room.size(), true);
    fcl::CollisionResultd result;
    fcl::collide(surface_.get(), tool_.get(), request, result);
    const std::size_t found = std::min(result.numContacts(), room.size());
    for (std::size_t i = 0; i < found; ++i) {
      const fcl::Contactd& c = result.getContact(i);
      // Its normal points from the first object, the surface, to the second.
      room[i] = {static_cast<std::uint32_t>(c.b1),
                 {c.pos.x(), c.pos.y(), c.pos.z()},
                 {-c.normal.x(), -c.normal.y(), -c.normal.z()},
                 c.penetration_depth};
    }
    return found;
  }

 private:
  std::unique_ptr<fcl::CollisionObjectd> surface_, tool_;
};

}  // namespace
}  // namespace hapbench

extern "C" std::unique_ptr<hapbench::Peer> hapbench_make_peer(const hapbench::PeerSurface& surface,
                                                              const hapbench::PeerDrill& drill) {
  return std::make_unique<hapbench::Fcl>(surface, drill);
}
