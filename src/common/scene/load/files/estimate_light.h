// What light a scene gets: a small picture of it, traced on the CPU before anything is rendered.
#pragma once

#include "common/image/image.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Incident radiance, as a surface weighs it, that counts as light.
struct LitRule {
  float least = 0;         ///< W / (m^2 sr)
  float part_of_mean = 0;  ///< and this part of the mean over the picture
};

struct Glimpse {
  Image picture;         ///< radiance, emission included
  double lit_share = 1;  ///< of the pixels of surfaces that reflect and do not shine themselves:
                         ///< those that are lit; 1 where no such surface is seen

  bool is_luminous = false;  ///< no such surface is seen
};

/// Of a scene that no renderer has prepared. The same on every machine: 32 x 32 pixels, 32 Sobol
/// samples each, paths of 5 rays.
class LightEstimate {
 public:
  /// Prepares a copy of the scene. Throws Error where it cannot be rendered.
  explicit LightEstimate(const SceneData& scene);

  /// `camera` describes one (check_camera) and has the far plane of the scene's own.
  Glimpse look(const CameraParameters& camera, const LitRule& rule);

 private:
  SceneData scene_;
};

}  // namespace pt
