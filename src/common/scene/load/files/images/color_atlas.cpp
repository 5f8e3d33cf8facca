#include "common/scene/load/files/images/color_atlas.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pt {
namespace {

constexpr std::size_t atlas_alignment = 16;  // of the first texel, bytes

}  // namespace

ColorAtlas::ColorAtlas(std::size_t triangles) {
  while (per_row_ * per_row_ < triangles) per_row_ *= 2;
  rows_ = std::max<std::size_t>((triangles + per_row_ - 1) / per_row_, 1);
  by_vertex_.assign(4 * per_row_ * rows_, Color(1.0f));
  by_face_.assign(4 * per_row_ * rows_, Color(1.0f));
}

void ColorAtlas::set(std::vector<Color>& texels, std::size_t block, const Color (&corners)[3]) {
  const std::size_t width = 2 * per_row_;
  Color* first = &texels[2 * (block / per_row_) * width + 2 * (block % per_row_)];
  first[0] = corners[0], first[1] = corners[1], first[width] = corners[2];
  first[width + 1] = corners[1] + corners[2] - corners[0];
}

void ColorAtlas::add_triangle(const Mesh& mesh, std::size_t triangle_index, Mesh& out) {
  const std::size_t block = used_++;
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  const auto width = static_cast<double>(2 * per_row_), height = static_cast<double>(2 * rows_);
  // Coordinates are rounded: a triangle keeps this distance, in texels, from the edges of the three
  // texels' triangle, beyond which colours could be negative.
  const double inset = width * 0x1p-22, side = 1.0 - 3.0 * inset;
  const double x = static_cast<double>(2 * (block % per_row_)) + 0.5 + inset;
  const double y = static_cast<double>(2 * (block / per_row_)) + 0.5 + inset;
  Color vertices[3], faces[3];
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.triangles[triangle_index].v[k];
    out.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
    out.uvs.emplace_back(static_cast<float>((x + (k == 1 ? side : 0.0)) / width),
                         static_cast<float>(1.0 - (y + (k == 2 ? side : 0.0)) / height));
    vertices[k] = mesh.colors.empty() ? Color(1.0f) : mesh.colors[v];
    faces[k] = mesh.face_colors.empty() ? Color(1.0f) : mesh.face_colors[triangle_index];
  }
  out.triangles.push_back({{first, first + 1, first + 2}});
  set(by_vertex_, block, vertices), set(by_face_, block, faces);
}

void ColorAtlas::add(Mesh& mesh) {
  Mesh out;
  out.positions.reserve(3 * mesh.triangles.size());
  out.uvs.reserve(3 * mesh.triangles.size());
  if (!mesh.normals.empty()) out.normals.reserve(3 * mesh.triangles.size());
  out.triangles.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) add_triangle(mesh, i, out);
  mesh.positions = std::move(out.positions), mesh.normals = std::move(out.normals);
  mesh.uvs = std::move(out.uvs), mesh.triangles = std::move(out.triangles);
}

void ColorAtlas::store(const std::vector<Color>& colors, Texture& texture,
                       std::vector<std::byte>& texels) const {
  texture = {};
  texture.format = TextureFormat::rgb32f;
  texture.wrap_u = texture.wrap_v = TextureWrap::clamp;
  texture.width = static_cast<std::uint32_t>(2 * per_row_);
  texture.height = static_cast<std::uint32_t>(2 * rows_);
  texture.offset = (texels.size() + atlas_alignment - 1) / atlas_alignment * atlas_alignment;
  texels.resize(texture.offset + colors.size() * sizeof(Color));
  std::memcpy(&texels[texture.offset], colors.data(), colors.size() * sizeof(Color));
}

}  // namespace pt
