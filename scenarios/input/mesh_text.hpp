#pragma once

#include <filesystem>
#include <string>

namespace hapbench {

/// Readers of the mesh library.
enum class MeshFormat { obj, off, binary_off, ply, stl, binary_stl };

/// The contents of a mesh file, fit for the mesh library.
struct MeshText {
  MeshFormat format;
  std::string text;
};

/// Reads a mesh file whole and makes it one that the mesh library (OpenMesh 9) reads as it is meant. The library
/// believes counts, skips vertices it cannot read so that all later ones are misnumbered, takes words for zeros, loses
/// its place where a face has a colour, and stumbles over a missing line end, comments and capitals. So text is checked
/// line by line and reduced to positions and faces; of binary files the declared sizes and properties are checked. What
/// is still wrong after that shows in the library's answer. Throws InputError that names file and line.
MeshText read_mesh_text(const std::filesystem::path& file);

}  // namespace hapbench
