// What a <scene> holds: sensor and integrator, emitters, media, shapes.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// `perspective`, `thinlens` or `orthographic` as the scene's camera; other sensors become a
/// pinhole with a warning. Width, height and samples per pixel become defaults.
void read_sensor(Context& context, const Object& sensor);

/// The angle of view of a sensor or a projector, along the axis that the file fixes, whatever the
/// image's final size.
void read_fov(const Object& sensor, CameraParameters& camera);

/// All types of <integrator>s, <emitter>s, <shape>s that are read.
std::vector<std::string> integrator_types();
std::vector<std::string> emitter_types();
std::vector<std::string> shape_types();

/// The types of all objects by their tag, in an order: those that are read, and Mitsuba 3.9's
/// others, which are replaced or left out with a warning. A dictionary, which has no tags, finds
/// its by this.
std::vector<std::pair<std::string, std::vector<std::string>>> plugin_types();

/// max_depth, rr_depth and hide_emitters; every integrator becomes a path tracer.
void read_integrator(Context& context, const Object& integrator);

// <emitter>s that are not on a shape.

/// Adds point, spot, projector, directional, constant, envmap or sunsky to the scene; others are
/// reported. Adding a kind is adding a line to the table in emitters.cpp.
void add_emitter(Context& context, const Object& emitter);

/// `sunsky`, `sky`, `sun`.
void add_daylight(Context& context, const Object& emitter);

// <medium>s to ours, and which lie on the sides of a shape.

/// The number of a medium in the scene; made once. None where it is of a kind that is not
/// supported, which is reported.
std::optional<std::uint16_t> read_medium(Context& context, const Object& medium);

/// What a shape has inside and outside of it.
struct ShapeMedia {
  bool any = false;  ///< it has at least one that is supported
  MediumBoundary boundary;
};
ShapeMedia media_of(Context& context, const Object& shape);

// The grids of media become the scene's.

/// To be called when the scene has its shapes and its sensor. Outside of the box around its density
/// there is nothing of a medium: where shapes leave it room there, its grid gets a layer of zeros.
void add_grids(Context& context);

// <shape>s to spheres, quads, meshes and instances.

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
/// Announces the file of a shape that has one (read_ahead.h).
void read_mesh_ahead(const Context& context, const Object& shape);
void add_memory(Context& context, const Object& shape, const Target& target);
void add_rectangle(Context& context, const Object& shape, const Target& target);
void add_cube(Context& context, const Object& shape, const Target& target);
void add_sphere(Context& context, const Object& shape, const Target& target);
void add_disk(Context& context, const Object& shape, const Target& target);
void add_cylinder(Context& context, const Object& shape, const Target& target);

}  // namespace pt::mitsuba
