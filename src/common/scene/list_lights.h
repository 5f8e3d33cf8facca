// All lights of a scene with triangles, and the table by which one is chosen.
#pragma once

#include "common/scene/scene_data.h"

namespace pt {

/// Triangles that emit (each instance's by itself, in world space), spheres, delta lights. Weights
/// are powers over pi, of directional lights that through the scene's bounding sphere. Triangles
/// are numbered through the meshes in their order. Throws Error for more than 2^24 of them.
LightListData list_lights(const SceneData& scene, const Bounds& bounds);

}  // namespace pt
