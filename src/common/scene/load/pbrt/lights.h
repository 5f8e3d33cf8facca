// Lights that are not on a shape.
#pragma once

#include "common/image/image.h"
#include "common/scene/load/pbrt/surfaces/colors.h"

namespace pt::pbrt {

/// A picture of all directions.
struct SkyPicture {
  Image image;
  bool is_equal_area = true;  ///< else by longitude and latitude, as earlier versions have it
  Affine to_light;
  Color scale = Color(1.0f);

  /// Of a direction in the light's space, without the scale.
  Color at(const Vec3& direction) const;
};

/// Adds point, spot, distant and infinite lights to the scene; others are reported. Adding a kind
/// is adding a line to the table in lights.cpp.
void add_lights(Context& context);

/// Infinite lights. Their constants and pictures add up; what they sum to is one map.
class SkyLights {
 public:
  void add(Context& context, const Entity& entity);
  void store(SceneData& scene) const;

 private:
  std::vector<SkyPicture> pictures_;
};

/// A spot whose transformation does not keep angles: its cone is one of its own space, not of the
/// world. A picture of its share of the intensity is what such a spot throws. `cone` is that of the
/// light's space, by its cosines, about `axis`.
void stretch_spot(Context& context, const Entity& entity, const Vec3& axis, DeltaLight& light);

/// `scale` of a light, times the film's imaging ratio. A colour in pbrt-v3.
Color read_light_scale(Context& context, const Parameters& parameters);

/// The file of a light's picture: 'filename', or 'mapname' in pbrt-v3. Null: it has none.
const Parameter* find_picture(const Parameters& parameters);

}  // namespace pt::pbrt
