// All lights of a scene with triangles, and the table by which one is chosen.
#pragma once

#include "common/options/options.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Triangles that emit (those of each instance separately, in world space), spheres, delta lights;
/// those without a position come last. Weights are powers over pi, of directional lights that
/// through the scene's bounding sphere; with `uniform` each emitter (a mesh, in one instance; a
/// sphere; a delta light) weighs 1, which its triangles share by their power. Triangles are
/// numbered through the meshes in their order. Throws Error for more than 2^24 of them.
/// `selection`: not automatic.
LightListData list_lights(const SceneData& scene, const Bounds& bounds, LightSelection selection);

/// The emitters that list_lights will find to give light, counted before quads become triangles.
std::size_t emitter_count(const SceneData& scene);

}  // namespace pt
