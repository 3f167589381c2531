#include <fcl/fcl.h>

#include <algorithm>

#include "tests/bench/peers/peer.hpp"

/// FCL: triangles in a tree of oriented boxes with rectangle swept spheres, its default for meshes, against its cylinder.
namespace hapbench::bench {
namespace {

using Surface = fcl::BVHModel<fcl::OBBRSSd>;

class Fcl final : public Peer {
 public:
  Fcl(const PeerSurface& surface, const PeerDrill& drill)
      : drill_(std::make_shared<fcl::Cylinderd>(drill.radius, drill.length)) {
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
    tool_ = std::make_unique<fcl::CollisionObjectd>(drill_);
  }

  PeerAnswer ask(const PeerPose& pose) override {
    const auto& r = pose.rotation;
    fcl::Matrix3d rotation;
    rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    tool_->setTransform(rotation, fcl::Vector3d(pose.centre[0], pose.centre[1], pose.centre[2]));
    constexpr std::size_t kAll = 100'000;
    const fcl::CollisionRequestd request(kAll, true);
    fcl::CollisionResultd result;
    fcl::collide(surface_.get(), tool_.get(), request, result);
    PeerAnswer answer{result.numContacts(), 0.0};
    for (std::size_t i = 0; i < result.numContacts(); ++i)
      answer.depth = std::max(answer.depth, result.getContact(i).penetration_depth);
    return answer;
  }

 private:
  std::shared_ptr<fcl::Cylinderd> drill_;
  std::unique_ptr<fcl::CollisionObjectd> surface_, tool_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl(const PeerSurface& surface, const PeerDrill& drill) {
  return std::make_unique<Fcl>(surface, drill);
}

}  // namespace hapbench::bench
