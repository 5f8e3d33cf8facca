// Texture coordinates of meshes that do not bring any, or that a texture's mapping replaces.
#pragma once

#include "common/geometry/mesh.h"
#include "common/scene/load/pbrt/description/texture_mapping.h"

namespace pt::pbrt {

/// Each triangle gets vertices of its own with the coordinates that pbrt gives it.
void add_default_uvs(Mesh& mesh);

/// Gives a mesh in the world the coordinates that the mapping says. Between the vertices they are
/// linear: right of a plane, near of a sphere or a cylinder whose triangles are small.
void map_vertices(Mesh& mesh, const TextureMapping& mapping);

}  // namespace pt::pbrt
