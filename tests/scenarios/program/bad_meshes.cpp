#include "tests/scenarios/program/bad_inputs.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/support/meshes.hpp"

namespace hapbench::test {
namespace {

/// A scenario whose environment is the mesh file `name` with these contents; `more` fields follow.
BadInput mesh(const std::string& test, const std::string& name, const std::string& contents, const std::string& says,
              const std::string& more = "") {
  return {
      test,
      with_value("plane", "/environment", R"({"type": "mesh", "scale": 0.001, "file": ")" + name + "\"" + more + "}"),
      "/environment/file",
      says,
      {{name, contents}}};
}

/// The same whose tool is the mesh.
BadInput mesh_tool(const std::string& test, const std::string& contents, const std::string& says,
                   const std::string& more = "") {
  return {test,
          with_value("plane", "/tool", R"({"type": "mesh", "scale": 0.001, "file": "tool.obj")" + more + "}"),
          "/tool/file",
          says,
          {{"tool.obj", contents}}};
}

const std::string kTriangle = "0 0 0\n1 0 0\n0 1 0\n";
const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::string mesh_ply(const std::string& faces, const std::string& format = "ascii",
                     const std::string& coordinate = "float",
                     const std::string& list = "property list uchar int vertex_indices\n") {
  const std::string property = "property " + coordinate + " ";
  return "ply\nformat " + format + " 1.0\nelement vertex 3\n" + property + "x\n" + property + "y\n" + property +
         "z\nelement face " + faces + "\n" + list + "end_header\n";
}

/// What surfaces the engine refuses, whatever the format.
std::vector<BadInput> bad_surfaces() {
  const TriangleSoup block = cube();
  return {
      mesh("MeshMoebiusBand", "m.obj", obj_text(moebius_band(9)),
           "is not orientable: no winding fits all faces around ("),
      mesh("MeshKleinBottle", "m.stl", binary_stl_text(klein_bottle(9, 7)), "is not orientable"),
      mesh("MeshWithoutFaces", "m.off", off_text({block.vertices, {}}), "has no faces; allowed: at least one"),
      mesh("MeshWithFacesOfTwoCorners", "m.off", off_text({block.vertices, {{0, 1, 1}}}), "has no faces; allowed"),
      mesh("MeshWithFacesWithoutArea", "m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n",
           "has no faces with an area; allowed: at least one"),
      mesh_tool("ToolMeshOpen", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "open"),
      mesh_tool("ToolMeshThinnerThanItsGrid", obj_text(block), "thin", R"(, "grid_m": 0.01)"),
      mesh("MeshTooFar", "m.obj", "v 0 0 0\nv 2e6 0 0\nv 0 1 0\nf 1 2 3\n",
           "vertex 1: got coordinate 2000 after scaling; allowed: at most 1000 m (is \"scale\" right?)"),
      mesh("MeshNeedsTooManyPoints", "m.obj", obj_text(block),
           "spacing_m 1e-09 would need more than 2e+07 points; allowed: a wider spacing", R"(, "spacing_m": 1e-9)"),
  };
}

std::vector<BadInput> bad_text_meshes() {
  return {
      mesh("ObjWithoutFaces", "m.obj", kObj, "has no faces"),
      mesh("ObjWithoutAnything", "m.obj", "# nothing\n", "has no faces"),
      mesh("ObjNanVertex", "m.obj", "v 0 nan 0\n", "m.obj, line 1: got \"nan\"; allowed: a finite number"),
      mesh("ObjInfiniteVertex", "m.obj", "v 0 0 -inf\n", "line 1: got \"-inf\"; allowed: a finite number"),
      mesh("ObjVertexBeyondDoublePrecision", "m.obj", "v 1e309 0 0\n",
           "line 1: got \"1e309\"; allowed: a finite number"),
      mesh("ObjShortVertex", "m.obj", "v 0 0\n", "line 1: got 2 coordinates; allowed: 3"),
      mesh("ObjShortFace", "m.obj", kObj + "f 1 2\n", "line 4: got a face with 2 corners; allowed: at least 3"),
      mesh("ObjWordInFace", "m.obj", kObj + "f 1 2 x/1\n", "line 4: got \"x/1\"; allowed: the number of a vertex"),
      mesh("ObjVertexZero", "m.obj", kObj + "f 0 1 2\n", "line 4: got \"0\"; allowed: the number of a vertex"),
      mesh("ObjVertexMissing", "m.obj", kObj + "f 1 2 4\n",
           "triangle 0: got vertex 3; allowed: 0 ... 2, the vertices of the file"),
      mesh("ObjVertexBeforeTheFirst", "m.obj", kObj + "f 1 2 -9\n",
           "line 4: got \"-9\"; allowed: the number of a vertex"),
      mesh("OffOtherHeader", "m.off", "PLY\n", "m.off, line 1: is not an OFF file; allowed: \"OFF\" in the first line"),
      mesh("OffFourDimensions", "m.off", "4OFF\n0 0 0\n", "line 1: is not an OFF file"),
      mesh("OffHeaderOnly", "m.off", "OFF\n", "the file ends before its counts"),
      mesh("OffNegativeCount", "m.off", "OFF\n3 -1 0\n" + kTriangle, "line 2: got \"-1\" faces; allowed: an integer"),
      mesh("OffHugeCount", "m.off", "OFF\n2000000000 1 0\n" + kTriangle,
           "the file ends before its 2000000000 vertices"),
      mesh("OffTooFewVertices", "m.off", "OFF\n3 0 0\n0 0 0\n", "the file ends before its 3 vertices"),
      mesh("OffTooFewFaces", "m.off", "OFF\n3 2 0\n" + kTriangle + "3 0 1 2\n", "the file ends before its 2 faces"),
      mesh("OffHugeFace", "m.off", "OFF\n3 1 0\n" + kTriangle + "2000000000 0 1 2\n", "face 0: got 2000000000 corners"),
      mesh("OffNanVertex", "m.off", "OFF\n3 1 0\n0 0 nan\n", "line 3: got \"nan\"; allowed: a finite number"),
      mesh("OffVertexMissing", "m.off", "OFF\n3 1 0\n" + kTriangle + "3 0 1 3\n", "triangle 0: got vertex 3; allowed:"),
      mesh("StlNanVertex", "m.stl", "solid\nouter loop\nvertex 0 0 nan\n", "line 3: got \"nan\"; allowed: a finite"),
      mesh("StlWithTwoVertices", "m.stl", "solid\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
           "m.stl, line 5: allowed after \"outer loop\": three vertices"),
      mesh("StlOtherWord", "m.stl", "solid\nsquare 0 0\n", "line 2: got \"square\"; allowed: solid, facet, outer loop"),
      mesh("StlWithoutFacets", "m.stl", "solid x\nendsolid x\n", "has no faces"),
      mesh("PlyMeshNanVertex", "m.ply", mesh_ply("1") + "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n",
           "got \"nan\"; allowed: a finite number"),
      mesh("PlyMeshWord", "m.ply", mesh_ply("1") + "0 0 0\n1 up 0\n0 1 0\n3 0 1 2\n",
           "got \"up\"; allowed: a finite number"),
      mesh("PlyMeshTooFewFaces", "m.ply", mesh_ply("2") + kTriangle + "3 0 1 2\n",
           "the file ends before its 2 \"face\"; allowed: a complete file"),
      mesh("PlyMeshVertexMissing", "m.ply", mesh_ply("1") + kTriangle + "3 0 1 3\n",
           "triangle 0: got vertex 3; allowed:"),
      mesh("PlyMeshNegativeVertex", "m.ply", mesh_ply("1") + kTriangle + "3 0 1 -1\n",
           "got \"-1\" as a vertex; allowed: an integer from 0"),
  };
}

std::vector<BadInput> bad_binary_meshes() {
  const TriangleSoup block = cube();
  const std::string stl = binary_stl_text(block), off = binary_off_text(block);
  const std::string nan = "\xff\xff\xff\x7f";
  return {
      mesh("StlNeither", "m.stl", "something else", "is no STL file, or cut short; allowed: \"solid\" and text, or"),
      mesh("StlCut", "m.stl", std::string(80, ' ') + stl.substr(80, stl.size() - 81), "is no STL file, or cut short"),
      mesh("StlHugeCount", "m.stl", std::string(80, ' ') + "\xff\xff\xff\xff" + stl.substr(84), "or cut short"),
      mesh("StlBinaryNanVertex", "m.stl", std::string(stl).replace(84 + 50 + 12, 4, nan),
           "m.stl: triangle 1: a vertex is not finite"),
      mesh("OffBinaryCut", "m.off", off.substr(0, off.size() - 1), "ends before its last face; allowed: a complete"),
      mesh("OffBinaryOfTheOtherEndian", "m.off", "OFF BINARY\n" + std::string("\0\0\0\x08\0\0\0\x0c\0\0\0\0", 12),
           "ends before its faces; allowed: a complete, little endian file"),
      mesh("OffBinaryWithColours", "m.off", "COFF BINARY\n", "allowed for a binary file: no normals, colours or"),
      mesh("OffBinaryShortFace", "m.off", std::string(off).replace(11 + 12 + 8 * 12, 4, std::string("\2\0\0\0", 4)),
           "m.off: face 0: got 2 corners; allowed: at least 3"),
      mesh("OffBinaryNanVertex", "m.off", std::string(off).replace(11 + 12 + 24, 4, nan), "vertex 2: is not finite"),
      mesh("PlyMeshBinaryCut", "m.ply", binary_ply_text(block, true, false).substr(0, 300),
           "m.ply: the file ends before its 12 \"face\"; allowed: a complete file"),
      mesh("PlyMeshBinaryNanVertex", "m.ply",
           mesh_ply("1", "binary_little_endian") + std::string(8, '\0') + nan + std::string(24, '\0') +
               std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13),
           "vertex 0: is not finite; allowed: finite coordinates"),
      mesh("PlyMeshHugeFace", "m.ply",
           mesh_ply("1", "binary_little_endian", "float", "property list int int vertex_indices\n") +
               std::string(36, '\0') + "\xff\xff\xff\x7f",
           "m.ply: the file ends before its 1 \"face\"; allowed: a complete file"),
      mesh("PlyMeshHugeCount", "m.ply", mesh_ply("4000000000", "binary_little_endian") + std::string(36, '\0'),
           "m.ply: the file ends before its 4000000000 \"face\"; allowed: a complete file"),
      mesh("PlyMeshWholeCoordinates", "m.ply", mesh_ply("1", "ascii", "int"),
           "line 4: allowed for a coordinate: float or"),
      mesh("PlyMeshWithoutFaceElement", "m.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n",
           "line 4: has no faces; allowed: \"element face COUNT\""),
      mesh("PlyMeshFacesFirst", "m.ply",
           "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
           "line 3: allowed before the faces: vertices with one each of x, y and z"),
      mesh("PlyMeshRealIndices", "m.ply",
           mesh_ply("1", "ascii", "float", "property uchar flag\nproperty list uchar float vertex_indices\n"),
           "line 9: allowed: \"property list COUNT TYPE NAME\" with an integer type COUNT, for the vertices of a face"),
      mesh("PlyMeshRealCount", "m.ply",
           mesh_ply("1", "ascii", "float", "property list uchar int vertex_indices\nproperty list float int more\n"),
           "line 9: allowed: \"property list COUNT TYPE NAME\" with an integer type COUNT"),
      mesh("PlyMeshOtherType", "m.ply",
           mesh_ply("1", "ascii", "float", "property list uchar int vertex_indices\nproperty word flag\n"),
           "line 9: allowed: \"property TYPE NAME\" or \"property list COUNT TYPE NAME\""),
      mesh("PlyMeshOtherList", "m.ply", mesh_ply("1", "ascii", "float", "property list uchar int corners\n"),
           "line 7: allowed for a face: one \"property list COUNT INDEX vertex_indices\""),
      mesh("PlyMeshTwoLists", "m.ply",
           mesh_ply("1", "ascii", "float",
                    "property list uchar int vertex_indices\nproperty list uchar int vertex_index\n"),
           "line 7: allowed for a face: one \"property list COUNT INDEX vertex_indices\""),
      mesh("PlyMeshShortFace", "m.ply", mesh_ply("1", "binary_little_endian") + std::string(36, '\0') + "\2",
           "m.ply: face 0: got 2 corners; allowed: at least 3"),
      mesh("PlyMeshNegativeList", "m.ply",
           mesh_ply("1", "binary_little_endian", "float",
                    "property list char int other\nproperty list uchar int vertex_indices\n") +
               std::string(36, '\0') + "\xff",
           "m.ply: \"face\" 0: got a list of -1 entries; allowed: an integer from 0"),
      mesh(
          "PlyMeshBinaryNegativeVertex", "m.ply",
          mesh_ply("1", "binary_big_endian") + std::string(36, '\0') + "\3" + std::string(8, '\0') + "\xff\xff\xff\xff",
          "m.ply: triangle 0: got vertex -1; allowed: 0 ... 2, the vertices of the file"),
      mesh("PlyMeshHeaderCut", "m.ply", mesh_ply("1").substr(0, mesh_ply("1").find("end_header")),
           "the header does not end"),
  };
}

}  // namespace

std::vector<BadInput> bad_mesh_files() {
  std::vector<BadInput> inputs = bad_surfaces();
  for (const auto& more : {bad_text_meshes(), bad_binary_meshes()})
    inputs.insert(inputs.end(), more.begin(), more.end());
  for (const char* extension : {"obj", "off", "stl", "ply"}) {
    const std::string name = std::string("m.") + extension;
    inputs.push_back(mesh(std::string("MeshEmpty_") + extension, name, "", "the file is empty; allowed: a mesh with"));
    BadInput missing = mesh(std::string("MeshMissing_") + extension, name, "", "cannot be read: No such file");
    missing.files.clear();
    inputs.push_back(missing);
    BadInput directory = mesh(std::string("MeshIsADirectory_") + extension, name, "", "is a directory, not a file");
    directory.files = {{name + "/inside", ""}};
    inputs.push_back(directory);
  }
  inputs.push_back(mesh("MeshOtherExtension", "m.3ds", "", "has another extension; allowed: .obj, .ply, .stl or .off"));
  return inputs;
}

}  // namespace hapbench::test
