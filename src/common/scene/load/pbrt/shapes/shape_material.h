// What a shape is made of: its material, its opacity and its light.
#pragma once

#include "common/scene/load/pbrt/surfaces/surfaces.h"

namespace pt::pbrt {

struct ShapeMaterial {
  MaterialDescription material;  ///< with its opacity, and its light but for `power`
  bool invisible = false;
  bool emits = false, two_sided = false;
  float power = 0.0f;       ///< above 0: all light that leaves it, instead of its radiance
  float light_mean = 1.0f;  ///< mean luminance of the picture that it shows; power counts it

  // What it needs of a shape:
  bool textured = false;   ///< texture coordinates
  TextureMapping mapping;  ///< which these are
  bool tangents = false;   ///< and the directions in which they grow
};

/// Reads each material and each area light once.
class ShapeMaterials {
 public:
  explicit ShapeMaterials(Context& context) : context_(context) {}

  ShapeMaterial read(const ShapeEntity& shape);

 private:
  struct AreaLight {
    Emission emission;
    bool two_sided = false;
    float power = 0.0f, mean = 1.0f;
  };
  const Surface& surface_of(const ShapeEntity& shape);
  const AreaLight& light_of(const Entity& entity);
  AreaLight read_light(const Entity& entity);
  void set_media(const ShapeEntity& shape, ShapeMaterial& result);
  void add_light(const ShapeEntity& shape, ShapeMaterial& result);

  Context& context_;
  std::map<MaterialReference, Surface> surfaces_;
  std::map<const Entity*, AreaLight> lights_;
};

}  // namespace pt::pbrt
