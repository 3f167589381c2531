#include "scenarios/input/mesh_library.hpp"

#include <fmt/format.h>

#include <OpenMesh/Core/IO/importer/ImporterT.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/OFFReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstring>
#include <sstream>

#include "scenarios/input/child_process.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<>;
using Position = std::array<float, 3>;
using Triangle = TriangleSoup::Triangle;

/// Takes vertices and faces as they come from a reader. OpenMesh's own importer would add faces to a mesh at once and
/// double the vertices of those that do not fit, which hides what is wrong with the surface.
class Collector final : public OpenMesh::IO::ImporterT<Mesh> {
 public:
  /// `most` of each: a file has no more vertices or faces than bytes, whatever it says.
  explicit Collector(std::size_t most) : ImporterT(no_mesh_), most_(most) {}

  std::vector<Position> positions;
  std::vector<Triangle> triangles;

  OpenMesh::VertexHandle add_vertex() override { return add_vertex(OpenMesh::Vec3f(0.0f, 0.0f, 0.0f)); }
  OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3d& p) override { return add_vertex(OpenMesh::Vec3f(p)); }
  OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& p) override {
    if (positions.size() == most_) throw std::bad_alloc();
    positions.push_back({p[0], p[1], p[2]});
    return OpenMesh::VertexHandle(static_cast<int>(positions.size()) - 1);
  }
  void set_point(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& p) override {
    positions.at(static_cast<std::size_t>(vertex.idx())) = {p[0], p[1], p[2]};
  }
  /// No handle comes back, which readers take for a face that did not fit: they set no attributes then.
  OpenMesh::FaceHandle add_face(const VHandles& corners) override {
    const auto index = [&corners](std::size_t i) { return static_cast<std::uint32_t>(corners[i].idx()); };
    for (std::size_t i = 2; i < corners.size(); ++i) {
      if (triangles.size() == most_) throw std::bad_alloc();
      triangles.push_back({index(0), index(i - 1), index(i)});
    }
    return OpenMesh::FaceHandle();
  }
  size_t n_vertices() const override { return positions.size(); }
  size_t n_faces() const override { return triangles.size(); }
  void reserve(unsigned, unsigned, unsigned) override {}

 private:
  Mesh no_mesh_;
  std::size_t most_;
};

bool read(const MeshText& mesh, const fs::path& file, std::istream& stream, Collector& collector) {
  OpenMesh::IO::Options options;
  switch (mesh.format) {
    case MeshFormat::obj:
      return OpenMesh::IO::OBJReader().read(stream, collector, options);
    case MeshFormat::ply:
      return OpenMesh::IO::PLYReader().read(stream, collector, options);
    case MeshFormat::binary_stl:
      options += OpenMesh::IO::Options::Binary;
      [[fallthrough]];
    case MeshFormat::stl:
      return OpenMesh::IO::STLReader().read(stream, collector, options);
    case MeshFormat::binary_off:
      // Only here does the reader learn that the file is binary.
      if (!OpenMesh::IO::OFFReader().can_u_read(file.string())) return false;
      [[fallthrough]];
    case MeshFormat::off:
      return OpenMesh::IO::OFFReader().read(stream, collector, options);
  }
  return false;
}

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  const std::size_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

/// Takes off the front what `append` put there; false when the bytes are no such thing.
template <class T>
bool take(std::string_view& bytes, std::vector<T>& values) {
  std::size_t count = 0;
  if (bytes.size() < sizeof count) return false;
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  if (count > bytes.size() / sizeof(T)) return false;
  values.resize(count);
  // An empty vector may have no address, which memcpy must not get.
  if (count > 0) std::memcpy(values.data(), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return true;
}

/// In the child: what was read, or nothing when the reader failed.
std::string collected(const MeshText& mesh, const fs::path& file) {
  std::istringstream stream(mesh.text);
  Collector collector(mesh.text.size());
  if (!read(mesh, file, stream, collector)) return "";
  // These readers go on with old values when the stream has failed; it stays so. The others read by lines to the end.
  const bool by_lines = mesh.format == MeshFormat::obj || mesh.format == MeshFormat::stl;
  if (!by_lines && stream.fail()) return "";
  std::string bytes;
  append(bytes, collector.positions);
  append(bytes, collector.triangles);
  return bytes;
}

/// Generous: a tenth would do for whole files on a slow machine.
ChildLimits limits_for(std::size_t bytes) {
  ChildLimits limits;
  limits.cpu_seconds = static_cast<unsigned>(1 + bytes / 1'000'000);
  limits.wall_seconds = 60 + 10 * limits.cpu_seconds;
  limits.memory = (std::size_t{1} << 29) + 64 * bytes;
  limits.answer = 16 + bytes * (sizeof(Position) + sizeof(Triangle));
  return limits;
}

const char* reason(ChildAnswer::End end) {
  switch (end) {
    case ChildAnswer::End::answered:
    case ChildAnswer::End::failed:
      return "it is cut short or damaged";
    case ChildAnswer::End::crashed:
      return "its reader crashed";
    case ChildAnswer::End::too_slow:
      return "its reader did not come to an end";
    case ChildAnswer::End::too_large:
      return "it declares more than it holds";
  }
  return "";
}

}  // namespace

TriangleSoup read_with_mesh_library(const MeshText& mesh, const fs::path& file) {
  const auto fail = [&file](const std::string& problem) {
    throw InputError(InputError::Kind::relation, file.string(), problem);
  };
  const ChildAnswer answer = answer_of_child([&] { return collected(mesh, file); }, limits_for(mesh.text.size()));
  std::string_view bytes = answer.bytes;
  std::vector<Position> positions;
  TriangleSoup soup;
  if (answer.end != ChildAnswer::End::answered || !take(bytes, positions) || !take(bytes, soup.triangles))
    fail(fmt::format("the mesh library cannot read it: {}; allowed: a complete file", reason(answer.end)));
  if (static_cast<double>(positions.size()) > kMostPoints)
    fail(fmt::format("has {} vertices; allowed: at most {:.0g}", positions.size(), kMostPoints));
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (const std::uint32_t vertex : soup.triangles[t]) {
      if (vertex >= positions.size()) {
        fail(fmt::format("triangle {}: got vertex {}; allowed: 0 ... {}, the vertices of the file", t,
                         static_cast<std::int32_t>(vertex), static_cast<std::int64_t>(positions.size()) - 1));
      }
    }
  }
  soup.vertices.reserve(positions.size());
  for (const Position& p : positions) soup.vertices.push_back(Vec3(p[0], p[1], p[2]));
  return soup;
}

}  // namespace hapbench
