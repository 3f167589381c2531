#include "scenarios/run/peer_contacts.hpp"

#include <fmt/format.h>

#include "scenarios/plugins/load_peer.hpp"
#include "scenarios/run/make_tool.hpp"
#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {
namespace {

void add(std::vector<double>& numbers, const Vec3& p) {
  numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
}

MakePeer& peer_of(const Scenario& scenario) {
  const std::string& name = scenario.rendering.contact_source;
  if (MakePeer* make = find_peer(name)) return *make;
  throw InputError(
      InputError::Kind::relation, "/rendering/contact_source",
      fmt::format("got \"{}\", which is not built here; allowed: \"{}\", or install {} and build the target "
                  "contact_sources",
                  name, kOwnContacts, peer_package(name)));
}

}  // namespace

PeerSurface peer_surface(const Scenario& scenario, const NamedFiles& files) {
  PeerSurface surface;
  const auto take = [&surface](const auto& triangles) {
    for (const auto& triangle : triangles)
      surface.triangles.insert(surface.triangles.end(), triangle.begin(), triangle.end());
  };
  if (const auto* block = std::get_if<BlockEnvironment>(&scenario.environment)) {
    const IsoSurface mesh =
        marching_cubes(density_field(block->block, block->grid, block->density), {.triangles = true});
    for (const SurfacePoint& vertex : mesh.vertices) add(surface.vertices, vertex.position);
    take(mesh.triangles);
  } else {
    const TriangleSoup mesh = files.at(kEnvironmentFile).mesh().triangles();
    for (const Vec3& vertex : mesh.vertices) add(surface.vertices, vertex);
    take(mesh.triangles);
  }
  return surface;
}

void require_contact_source(const Scenario& scenario) {
  if (scenario.rendering.contact_source != kOwnContacts) peer_of(scenario);
}

std::unique_ptr<ContactSource> make_peer_source(const Scenario& scenario, const NamedFiles& files) {
  const Cylinder drill = make_cylinder(scenario.tool);
  const PeerSurface surface = peer_surface(scenario, files);
  return std::make_unique<PeerSource>(peer_of(scenario)(surface, {drill.radius(), drill.length()}),
                                      scenario.rendering.contact_source, drill.length(), surface.triangles.size() / 3);
}

}  // namespace hapbench
