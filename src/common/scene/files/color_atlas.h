// The texture of vertex_colors.h: 2 x 2 texels for each triangle.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/texture/texture.h"

namespace pt {

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

}  // namespace pt
