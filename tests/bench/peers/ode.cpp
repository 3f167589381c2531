#include <ode/ode.h>

#include <algorithm>

#include "tests/bench/peers/contact_library.hpp"

/// ODE. Its cylinder is tested against its triangle mesh (OPCODE). Lengths are in millimetres. ODE returns contacts
/// until the given array is full.
namespace hapbench::bench {
namespace {

constexpr double kMillimetres = 1e3;
constexpr int kRoom = 0xffff;  // largest number that ODE accepts

class Ode final : public Peer {
 public:
  explicit Ode(const HapbenchRun& run)
      : vertices_(run.vertices, run.vertices + 3 * run.vertex_count),
        triangles_(run.triangles, run.triangles + 3 * run.triangle_count),
        contacts_(kRoom) {
    dInitODE();
    for (dReal& x : vertices_) x *= static_cast<dReal>(kMillimetres);
    data_ = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(data_, vertices_.data(), 3 * sizeof(dReal), static_cast<int>(vertices_.size() / 3),
                                triangles_.data(), static_cast<int>(triangles_.size()), 3 * sizeof(dTriIndex));
    mesh_ = dCreateTriMesh(nullptr, data_, nullptr, nullptr, nullptr);
    drill_ = dCreateCylinder(nullptr, kMillimetres * run.tool_radius, kMillimetres * run.tool_length);
  }
  ~Ode() {
    dGeomDestroy(drill_);
    dGeomDestroy(mesh_);
    dGeomTriMeshDataDestroy(data_);
    dCloseODE();
  }
  Ode(const Ode&) = delete;
  Ode& operator=(const Ode&) = delete;

  std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) override {
    const auto& r = pose.rotation;
    const dMatrix3 rotation = {r[0], r[1], r[2], 0.0, r[3], r[4], r[5], 0.0, r[6], r[7], r[8], 0.0};
    dGeomSetRotation(drill_, rotation);
    dGeomSetPosition(drill_, kMillimetres * pose.centre[0], kMillimetres * pose.centre[1],
                     kMillimetres * pose.centre[2]);
    const auto given = static_cast<std::size_t>(dCollide(mesh_, drill_, kRoom, contacts_.data(), sizeof(dContactGeom)));
    const std::size_t found = std::min(given, room.size());
    for (std::size_t i = 0; i < found; ++i) room[i].depth = contacts_[i].depth / kMillimetres;
    return found;
  }

 private:
  std::vector<dReal> vertices_;
  std::vector<dTriIndex> triangles_;
  std::vector<dContactGeom> contacts_;
  dTriMeshDataID data_;
  dGeomID mesh_, drill_;
};

}  // namespace

std::unique_ptr<Peer> ode(const HapbenchRun& run) {
  return std::make_unique<Ode>(run);
}

}  // namespace hapbench::bench
