#include "common/scene/load/files/meshes/vertex_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/scene/load/files/importer.h"
#include "common/texture/sample_texture.h"
#include "common/texture/texture.h"

namespace pt {
namespace {

class ColorAtlas {
 public:
  /// Room for so many triangles, white.
  explicit ColorAtlas(std::size_t triangles);

  /// Gives the mesh vertices of its own for each triangle, with coordinates of the next free
  /// texels, and these the mesh's colours, white where it has none.
  void add(Mesh& mesh);

  /// Appends the texels to those of a scene; `texture` shows them.
  void store_vertices(Texture& texture, std::vector<std::byte>& texels) const {
    store(by_vertex_, texture, texels);
  }
  void store_faces(Texture& texture, std::vector<std::byte>& texels) const {
    store(by_face_, texture, texels);
  }

 private:
  void add_triangle(const Mesh& mesh, std::size_t triangle_index, Mesh& out);
  void set(std::vector<Color>& texels, std::size_t block, const Color (&corners)[3]);
  void store(const std::vector<Color>& colors, Texture& texture,
             std::vector<std::byte>& texels) const;

  std::size_t per_row_ = 1, rows_ = 1;  ///< of triangles; per_row_ is a power of two
  std::size_t used_ = 0;
  std::vector<Color> by_vertex_, by_face_;
};

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
  const auto first = static_cast<std::uint32_t>(out.uvs.size());
  const auto width = static_cast<double>(2 * per_row_), height = static_cast<double>(2 * rows_);
  // Coordinates are rounded: a triangle keeps this distance, in texels, from the edges of the three
  // texels' triangle, beyond which colours could be negative.
  const double inset = width * 0x1p-22, side = 1.0 - 3.0 * inset;
  const double x = static_cast<double>(2 * (block % per_row_)) + 0.5 + inset;
  const double y = static_cast<double>(2 * (block / per_row_)) + 0.5 + inset;
  Color vertices[3], faces[3];
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.triangles[triangle_index].v[k];
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
  out.uvs.reserve(3 * mesh.triangles.size());
  out.triangles.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) add_triangle(mesh, i, out);
  const auto spread = [&](std::vector<Vec3>& by_vertex) {
    std::vector<Vec3> by_corner;
    by_corner.reserve(out.uvs.size());
    for (const TriangleIndices& t : mesh.triangles)
      for (const std::uint32_t v : t.v) by_corner.push_back(by_vertex[v]);
    by_vertex = std::move(by_corner);
  };
  spread(mesh.positions);
  if (!mesh.normals.empty()) spread(mesh.normals);
  for (auto* later : {&mesh.later_positions, &mesh.later_normals})
    for (std::vector<Vec3>& set : *later) spread(set);
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

namespace {

bool all_equal(const std::vector<Color>& colors) {
  return std::ranges::all_of(colors, [&](const Color& c) { return c == colors.front(); });
}

/// The mean over all corners of triangles; white for a mesh without colours.
Color mean_of_vertices(const Mesh& mesh) {
  if (mesh.colors.empty() || mesh.triangles.empty()) return Color(1.0f);
  if (all_equal(mesh.colors)) return mesh.colors.front();
  double sum[3] = {};
  for (const TriangleIndices& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle.v) {
      for (int i = 0; i < 3; ++i) sum[i] += mesh.colors[v][i];
    }
  }
  const double scale = 1.0 / (3.0 * static_cast<double>(mesh.triangles.size()));
  return {static_cast<float>(scale * sum[0]), static_cast<float>(scale * sum[1]),
          static_cast<float>(scale * sum[2])};
}

Color mean_of_faces(const Mesh& mesh) {
  if (mesh.face_colors.empty()) return Color(1.0f);
  Vec3 sum(0.0f);
  for (const Color& c : mesh.face_colors) sum += c;
  return sum / static_cast<float>(mesh.face_colors.size());
}

}  // namespace

void VertexColors::report_mean(const std::string& place) {
  if (reported_) return;
  reported_ = true;
  options_.report(place +
                  ": colours of vertices or faces beside textures or in an anisotropic material "
                  "are not supported: their mean is used");
}

std::uint32_t VertexColors::texture_index_of(std::uint32_t& texture) {
  if (texture == none) {
    texture = static_cast<std::uint32_t>(scene_.textures.size());
    scene_.textures.emplace_back();  // without texels until finish()
  }
  return texture;
}

VertexColors::Use VertexColors::use_of(std::uint32_t material_index) const {
  Use use;
  const auto note = [&](std::uint32_t texture) {
    if (texture == no_texture) return;
    (texture == vertex_ ? use.by_vertex : texture == face_ ? use.by_face : use.others) = true;
  };
  for (const MaterialDescription* part : parts_of(scene_, scene_.materials[material_index])) {
    for (const Parameter& p : part->parameters) note(p.texture);
    note(part->emission.texture), note(part->opacity.texture);
    const bool is_bsdf = part->node == MaterialNode::none;
    use.others |= is_bsdf ? uses_tangent(*part) : part->node >= MaterialNode::normal_map;
  }
  return use;
}

/// The number of a copy with the change to the material and to what it is made of, each once.
std::uint32_t VertexColors::changed(std::uint32_t material_index, const Change& change) {
  std::map<std::uint32_t, std::uint32_t> copies;
  return changed(material_index, change, copies);
}

std::uint32_t VertexColors::changed(std::uint32_t material_index, const Change& change,
                                    std::map<std::uint32_t, std::uint32_t>& copies) {
  if (const auto copy = copies.find(material_index); copy != copies.end()) return copy->second;
  MaterialDescription material = scene_.materials[material_index];
  if (material.node != MaterialNode::none) {
    for (std::uint32_t& child : material.children) child = changed(child, change, copies);
  }
  change(material);
  return copies[material_index] = scene_.add_material(material);
}

void VertexColors::tint(Mesh& mesh, bool emits, const std::string& place) {
  if (mesh.colors.empty()) return;
  const bool uniform = all_equal(mesh.colors), others = use_of(mesh.material).others;
  if (uniform || others) {
    if (!uniform) {
      report_mean(place);
    }
    const Color mean = mean_of_vertices(mesh);
    if (mean == Color(1.0f)) return;
    mesh.material = changed(mesh.material, [&](MaterialDescription& m) {
      if (emits) m.emission.radiance *= mean;
      if (!emits && m.node == MaterialNode::none) m.parameters[color_parameter].value *= mean;
    });
    return;
  }
  const auto [entry, is_new] = tinted_.try_emplace({mesh.material, emits}, 0u);
  if (is_new) {
    const std::uint32_t texture = by_vertex();
    entry->second = changed(mesh.material, [&](MaterialDescription& m) {
      if (emits) m.emission.texture = texture;
      // The first parameter of a blend is its weight.
      if (!emits && m.node == MaterialNode::none) m.parameters[color_parameter].texture = texture;
    });
  }
  mesh.material = entry->second;
}

/// Gives the mesh a material of its own, with the colours' means for the textures that stand for
/// them.
void VertexColors::show_means(Mesh& mesh) {
  const Color by_vertices = mean_of_vertices(mesh), by_faces = mean_of_faces(mesh);
  const auto replace = [&](std::uint32_t& texture, Color& value) {
    if (!is_ours(texture)) return;
    value *= texture == vertex_ ? by_vertices : by_faces;
    texture = no_texture;
  };
  mesh.material = changed(mesh.material, [&](MaterialDescription& m) {
    for (Parameter& p : m.parameters) replace(p.texture, p.value);
    replace(m.emission.texture, m.emission.radiance);
    Color opacity(1.0f);
    replace(m.opacity.texture, opacity);
    if (m.opacity.is_constant()) m.opacity.offset += m.opacity.scale * grey_of(opacity);
    if (m.opacity.is_constant()) m.opacity.scale = 0.0f;
  });
}

void VertexColors::report_lack(const char* attribute, bool lacks) {
  if (!lacks || !lacks_.insert(attribute).second) return;
  options_.report(
      fmt::format("scene '{}': a mesh has no attribute '{}' for its material: white is used",
                  scene_.name, attribute));
}

bool VertexColors::shows_texels(Mesh& mesh) {
  const Use use = use_of(mesh.material);
  if (!use.colors()) return false;
  report_lack("vertex_color", use.by_vertex && mesh.colors.empty());
  report_lack("face_color", use.by_face && mesh.face_colors.empty());
  const bool uniform = all_equal(mesh.colors) && all_equal(mesh.face_colors);
  if (use.others && !uniform) {
    report_mean(fmt::format("scene '{}'", scene_.name));
  }
  if (use.others || uniform) show_means(mesh);
  return !use.others && !uniform;
}

void VertexColors::finish() {
  std::vector<Mesh*> shown;
  std::size_t triangles = 0;
  for (Mesh& mesh : scene_.meshes) {
    if ((vertex_ == none && face_ == none) || !shows_texels(mesh)) continue;
    shown.push_back(&mesh);
    triangles += mesh.triangles.size();
  }
  ColorAtlas atlas(triangles);
  for (Mesh* mesh : shown) atlas.add(*mesh);
  if (vertex_ != none) atlas.store_vertices(scene_.textures[vertex_], scene_.texels);
  if (face_ != none) atlas.store_faces(scene_.textures[face_], scene_.texels);
  for (Mesh& mesh : scene_.meshes) mesh.colors.clear(), mesh.face_colors.clear();
}

}  // namespace pt
