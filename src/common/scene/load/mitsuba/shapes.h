// <shape>s to spheres, quads, meshes and instances.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// Adds a shape to group `group` of the scene; 0 is the world. Rectangles and cubes of the world
/// become quads, spheres stay spheres; textured ones, flipped or squeezed spheres and what is in
/// another group become meshes, as our quads and spheres have no texture coordinates and face
/// outward. Adding a kind of shape is adding a line to the table in shapes.cpp.
void add_shape(Context& context, const Object& shape, std::uint32_t group);

// The kinds of shapes: each adds one to the scene.

/// Where a shape goes and what it is made of.
struct Target {
  Affine to_world;  ///< invertible
  std::uint32_t group;
  std::uint32_t material;
  bool textured;    ///< shading asks where on it a point lies
  bool tangents;    ///< and in which directions u and v grow there
  bool needs_mesh;  ///< masked, of a mesh's colours, or a lamp with a texture

  /// Quads and spheres: in the world, without texture coordinates.
  bool analytic() const { return group == 0 && !textured && !needs_mesh; }
};

/// Adds a mesh in a shape's own space, placed by `to_world` and the shape's normals and flips.
void add_mesh(Context& context, const Object& shape, const Target& target, Mesh mesh,
              const Affine& to_world);

void add_file(Context& context, const Object& shape, const Target& target);
void add_memory(Context& context, const Object& shape, const Target& target);
void add_rectangle(Context& context, const Object& shape, const Target& target);
void add_cube(Context& context, const Object& shape, const Target& target);
void add_sphere(Context& context, const Object& shape, const Target& target);
void add_disk(Context& context, const Object& shape, const Target& target);
void add_cylinder(Context& context, const Object& shape, const Target& target);

}  // namespace pt::mitsuba
