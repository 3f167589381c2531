#include "tests/scenarios/support/mesh_texts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <ostream>

namespace hapbench::test {
namespace {

/// Returns the bytes of a number in the given byte order.
template <class T>
std::string bytes(T value, bool little_endian = true) {
  std::string text(sizeof value, '\0');
  std::copy_n(reinterpret_cast<const char*>(&value), sizeof value, text.begin());
  if (little_endian != (std::endian::native == std::endian::little)) std::reverse(text.begin(), text.end());
  return text;
}

template <class T>
std::string bytes(const Vec3& v, bool little_endian = true) {
  std::string text;
  for (const double c : v) text += bytes(static_cast<T>(c), little_endian);
  return text;
}

std::string words(const Vec3& v) {
  return fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
}

std::string ply_header(const TriangleSoup& soup, const char* format, const char* type) {
  return fmt::format(
      "ply\nformat {0} 1.0\nelement vertex {2}\nproperty {1} x\nproperty {1} y\nproperty {1} z\nelement face {3}\n"
      "property list uchar int vertex_indices\nend_header\n",
      format, type, soup.vertices.size(), soup.triangles.size());
}

}  // namespace

std::string obj_text(const TriangleSoup& soup) {
  std::string text = "# a mesh\no thing\n";
  for (const Vec3& v : soup.vertices) text += "v " + words(v);
  for (const auto& t : soup.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string off_text(const TriangleSoup& soup) {
  std::string text = fmt::format("OFF\n{} {} 0\n", soup.vertices.size(), soup.triangles.size());
  for (const Vec3& v : soup.vertices) text += words(v);
  for (const auto& t : soup.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string stl_text(const TriangleSoup& soup) {
  std::string text = "solid thing\n";
  for (const auto& t : soup.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : t) text += "vertex " + words(soup.vertices[v]);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid thing\n";
}

std::string ply_text(const TriangleSoup& soup) {
  std::string text = ply_header(soup, "ascii", "double");
  for (const Vec3& v : soup.vertices) text += words(v);
  for (const auto& t : soup.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string binary_stl_text(const TriangleSoup& soup) {
  std::string text = "solid as some programs call it";
  text.resize(80);
  text += bytes(static_cast<std::uint32_t>(soup.triangles.size()));
  for (const auto& t : soup.triangles) {
    text += std::string(12, '\0');
    for (const std::uint32_t v : t) text += bytes<float>(soup.vertices[v]);
    text += std::string(2, '\0');
  }
  return text;
}

std::string binary_ply_text(const TriangleSoup& soup, bool little_endian, bool doubles) {
  std::string text =
      ply_header(soup, little_endian ? "binary_little_endian" : "binary_big_endian", doubles ? "double" : "float");
  for (const Vec3& v : soup.vertices)
    text += doubles ? bytes<double>(v, little_endian) : bytes<float>(v, little_endian);
  for (const auto& t : soup.triangles) {
    text += '\3';
    for (const std::uint32_t v : t) text += bytes(static_cast<std::int32_t>(v), little_endian);
  }
  return text;
}

void PrintTo(const NamedText& text, std::ostream* out) {
  *out << text.name;
}

std::vector<NamedText> mesh_texts(const TriangleSoup& soup) {
  return {{"text.obj", obj_text(soup)},
          {"text.off", off_text(soup)},
          {"text.stl", stl_text(soup)},
          {"text.ply", ply_text(soup)},
          {"binary.stl", binary_stl_text(soup)},
          {"little_float.ply", binary_ply_text(soup, true, false)},
          {"little_double.ply", binary_ply_text(soup, true, true)},
          {"big_float.ply", binary_ply_text(soup, false, false)},
          {"big_double.ply", binary_ply_text(soup, false, true)}};
}

}  // namespace hapbench::test
