// Puts shapes into the scene.
#pragma once

#include "common/scene/load/pbrt/shapes/shape_material.h"

namespace pt::pbrt {

/// A mesh in the space of the entity. Its material's light is complete then.
void place_mesh(Context& context, const ShapeEntity& entity, const ShapeMaterial& material,
                bool is_quadric, Mesh mesh);

/// A whole sphere around the entity's origin, where ours can be as pbrt's: unless it is squeezed,
/// repeated, masked, textured by its points, or a lamp that shows a picture or shines inward. Tells
/// whether.
bool place_sphere(Context& context, const ShapeEntity& entity, const ShapeMaterial& material,
                  float radius);

}  // namespace pt::pbrt
