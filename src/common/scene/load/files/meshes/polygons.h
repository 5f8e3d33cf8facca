// Faces of more than three corners.
//
// Readers make each a fan of triangles around its first corner, which is right where that corner
// sees the whole face. Else its triangles are exchanged for as many others, found by clipping ears
// (Meisters 1975): no library that Debian 12 has does this for a face in space.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/mesh.h"

namespace pt {

/// The fans among the triangles of a mesh. A reader tells each that it makes.
class PolygonFans {
 public:
  /// The next face has so many triangles, 1 or more, and follows the one before.
  void add(std::uint64_t triangles);
  /// The next `faces` have so many triangles each. Once for a mesh.
  void add_equal(std::uint64_t faces, std::uint64_t triangles);
  /// The next triangles are faces of their own.
  void skip(std::uint64_t triangles) { next_ += triangles; }

  /// Exchanges the triangles of faces that are no fans. Corners keep their order around the face,
  /// so that normals keep their side. Faces are cut as seen along their normal (Newell's), in which
  /// those that are not planar or touch themselves have a shape; one that crosses itself or has no
  /// area stays as it is. `warnings` (or null) is told of faces that were too large to be cut.
  void cut_concave(Mesh& mesh, std::vector<std::string>* warnings) const;

 private:
  struct Place {
    std::uint64_t first, triangles;
  };

  std::vector<Place> fans_;  ///< of two triangles or more
  Place equal_{};            ///< the first of those that are equal
  std::uint64_t equals_ = 0;
  std::uint64_t next_ = 0;  ///< the first triangle of the next face
};

}  // namespace pt
