// All lights of a scene with triangles, and the table by which one is chosen.
#pragma once

#include "common/light/light_sample.h"
#include "common/math/transform.h"
#include "common/options/options.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Triangles that emit (those of each instance separately, in world space), spheres, delta lights;
/// those without a position come last. Weights are powers over pi, of directional lights that
/// through the scene's bounding sphere; with `uniform` each emitter (a mesh, in one instance; a
/// sphere; a delta light) weighs 1, which its triangles share by their power. Triangles are
/// numbered through the meshes in their order. Throws Error for more than 2^24 of them.
/// `selection`: not automatic. After prepare_motion().
LightListData list_lights(const SceneData& scene, const Bounds& bounds, LightSelection selection);

/// The emitters that list_lights will find to give light, counted before quads become triangles.
std::size_t emitter_count(const SceneData& scene);

/// The errors of one instance's triangles, or of the world's. A light is sampled in the world,
/// where its first vertex has been rounded; a ray is taken to the instance's own space, where its
/// origin is rounded. Both count in the world.
class PlacementErrors {
 public:
  /// `to_world`: null where the triangles lie in the world. Must not be singular.
  explicit PlacementErrors(const Affine* to_world);

  /// The triangle's vertices in its own space.
  LightError of_triangle(const Vec3 vertices[3]) const;

  /// From the first vertex to another one, in the world.
  Vec3 edge(const Vec3 vertices[3], int to) const {
    const Vec3 own = vertices[to] - vertices[0];
    return placed_ ? to_world_.vector(own) : own;
  }

 private:
  bool placed_ = false;
  Affine to_world_, to_object_;
  Affine linear_;           ///< to_world without its translation
  float condition_ = 1.0f;  ///< what a relative error in the instance's space becomes, at most
};

}  // namespace pt
