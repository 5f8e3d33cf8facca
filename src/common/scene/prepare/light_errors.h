// Bounds of the distance between an emissive triangle and the point at which a ray hits it.
#pragma once

#include "common/light/light_sample.h"
#include "common/math/transform.h"

namespace pt {

/// The errors of one instance's triangles, or of the world's. A light is sampled in the world,
/// where its first vertex has been rounded; a ray is taken to the instance's own space, where its
/// origin is rounded. Both count in the world.
class PlacementErrors {
 public:
  /// `to_world`: null where the triangles lie in the world. Must not be singular.
  explicit PlacementErrors(const Affine* to_world);

  /// The triangle's vertices in its own space, and its edges from the first one in the world.
  LightError of_triangle(const Vec3 vertices[3], const Vec3& edge1, const Vec3& edge2) const;

 private:
  bool placed_ = false;
  Affine to_world_, to_object_;
  Affine linear_;           ///< to_world without its translation
  float condition_ = 1.0f;  ///< what a relative error in the instance's space becomes, at most
};

}  // namespace pt
